// Beyond chance and large enough to matter: only both together fail. Either alone is told.
#include "server/fleet/findings/effect.h"

#include <gmock/gmock.h>

#include "tests/unit/fleet/rig.h"

namespace rigcal::fleet {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr double kDegree_rad = M_PI / 180;

// A rig of one session of many captures, one of whose edges the others speak against by so much: `times` the limit of
// its test.
Rig OffBy(double off_m, double off_rad, double times) {
  Rig rig;
  for (Edge& edge : rig.edges) edge.session = SessionId(std::string(64, '1'));
  rig.solution.influences.judged = true;
  for (const Edge& edge : rig.edges) {
    EdgeInfluence influence;
    influence.edge = edge.id;
    influence.checked = true;
    rig.solution.influences.edges.push_back(influence);
  }
  for (EdgeResidual& residual : rig.solution.residuals)
    residual.by_jackknife = true, residual.rank = 6, residual.dof = 39.0, residual.t_squared = 6.0;
  EdgeResidual& worst = rig.solution.residuals[1];
  worst.t_squared = times * TestResidual(rig.edges[1], worst, 3).limit;
  rig.solution.influences.edges[1].off << 0, off_m, 0, off_rad, 0, 0;
  return rig;
}

struct Case {
  double off_m = 0.0, off_rad = 0.0, times = 0.0;
  VerdictLevel level = VerdictLevel::kPass;
};

class SignificanceAndEffect : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(
    Table, SignificanceAndEffect,
    testing::Values(Case{0.0001, 0.0, 0.9, VerdictLevel::kPass},                    // neither
                    Case{0.000119, 0.008 * kDegree_rad, 4.0, VerdictLevel::kPass},  // beyond chance, and nothing
                    Case{0.001, kDefaultMovedMin.rad, 4.0, VerdictLevel::kPass},    // as large as the limit keeps it
                    Case{0.0010001, 0.0, 4.0, VerdictLevel::kFail},
                    Case{0.0, 0.0501 * kDegree_rad, 4.0, VerdictLevel::kFail},
                    Case{0.002, 0.2 * kDegree_rad, 1.01, VerdictLevel::kFail},
                    Case{0.002, 0.2 * kDegree_rad, 1.0, VerdictLevel::kPass},  // may be chance, within the tolerance
                    Case{0.005, 0.0, 0.99, VerdictLevel::kPass}, Case{0.0050001, 0.0, 0.99, VerdictLevel::kWarn},
                    Case{0.0, 0.0051, 0.2, VerdictLevel::kWarn}, Case{0.025, 0.0, 0.1, VerdictLevel::kWarn},
                    Case{0.025, 0.0, 2.0, VerdictLevel::kFail}));

TEST_P(SignificanceAndEffect, OfAnEdge) {
  const Case& given = GetParam();
  const Verdict verdict = OffBy(given.off_m, given.off_rad, given.times).Judge();
  EXPECT_EQ(verdict.level, given.level) << verdict.why;
}

CycleResidual Loop(double off_m, double off_rad, double times) {
  CycleResidual loop;
  for (const char* name : {"left", "right", "top"}) loop.sensors.emplace_back(name);
  loop.e << off_m, 0.0, 0.0, 0.0, 0.0, off_rad;
  loop.tested = true;
  loop.t_squared = 40.0 * times, loop.limit = 40.0;
  return loop;
}

Rig WithLoops(std::vector<CycleResidual> loops) {
  Rig rig = OffBy(0.0, 0.0, 0.1);
  rig.solution.cycles.judged = true;
  rig.solution.cycles.tested = static_cast<std::int64_t>(loops.size());
  for (const CycleResidual& loop : loops) rig.solution.cycles.failing += loop.fails() ? 1 : 0;
  rig.solution.cycles.worst = std::move(loops);
  return rig;
}

TEST_P(SignificanceAndEffect, OfALoop) {
  const Case& given = GetParam();
  const Verdict verdict = WithLoops({Loop(given.off_m, given.off_rad, given.times)}).Judge();
  EXPECT_EQ(verdict.level, given.level) << verdict.why;
}

TEST(Effect, WhatIsBeyondChanceAndSmallIsToldByAPass) {
  EXPECT_EQ(OffBy(0.000119, 0.008 * kDegree_rad, 4.0).Judge().why,
            "right and top differ by 0.119 mm and 0.008 deg, more than chance but within 1 mm and 0.05 deg. Every "
            "sensor is known "
            "well enough.");
  EXPECT_EQ(WithLoops({Loop(0.00012, 0.0, 4.0)}).Judge().why,
            "The loop of left, right and top is open by 0.12 mm and 0 deg, more than chance but within 1 mm and 0.05 "
            "deg. Every "
            "sensor is known well enough.");
}

TEST(Effect, AndWhereAPoseIsTooUncertain) {
  Rig rig = OffBy(0.000119, 0.0, 4.0);
  rig.solution.poses[1].covariance(0, 0) = 1e-4;
  const Verdict verdict = rig.Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kUnknown);
  EXPECT_THAT(verdict.why, testing::StartsWith("The pose of right is known to 10 mm"));
  EXPECT_THAT(verdict.why, HasSubstr("wanted). right and top differ by 0.119 mm"));
}

TEST(Effect, WhatMayBeChanceButIsTooMuchIsNamedWithItsTolerance) {
  const Verdict verdict = OffBy(0.025, 0.0, 0.1).Judge();
  EXPECT_EQ(verdict.why, "right and top differ by 25 mm and 0 deg, more than the tolerance of 5 mm and 0.29 deg.");
  EXPECT_EQ(verdict.what_to_do, "Capture right and top again, nearer and from more places, until they agree.");
}

TEST(Effect, ASmallOpenLoopDoesNotHideALargeOne) {
  const Verdict verdict = WithLoops({Loop(0.0001, 0.0, 9.0), Loop(0.01, 0.0, 3.0)}).Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kFail);
  EXPECT_THAT(verdict.why, HasSubstr("does not close: 10 mm"));
  EXPECT_THAT(verdict.why, Not(HasSubstr("loops do not")));
}

TEST(Effect, WhereNobodyKnowsHowFarAnEdgeIsOffChanceAloneDecides) {
  Rig rig = OffBy(0.0, 0.0, 2.0);
  rig.solution.influences = {};
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kFail);
}

TEST(Effect, TheLimitsOfThePairHold) {
  const Rig rig = OffBy(0.003, 0.0, 4.0), coarse = OffBy(0.025, 0.0, 0.1);
  Policy policy;
  policy.sensors[SensorId("top")].moved_min_m = 0.004;
  EXPECT_EQ(Assess(rig.edges, rig.solution, policy).level, VerdictLevel::kPass);
  policy.pairs[{SensorId("right"), SensorId("top")}].moved_min_m = 0.002;
  EXPECT_EQ(Assess(rig.edges, rig.solution, policy).level, VerdictLevel::kFail);
  policy.pairs[{SensorId("right"), SensorId("top")}].tolerance_m = 0.03;
  EXPECT_EQ(Assess(coarse.edges, coarse.solution, policy).level, VerdictLevel::kPass);
}

// However large a move the policy takes for none.
TEST(Effect, WhatIsBeyondTheToleranceIsNoPass) {
  const Rig rig = OffBy(0.008, 0.0, 4.0);
  Policy policy;
  policy.all.moved_min_m = 0.01;
  EXPECT_EQ(Assess(rig.edges, rig.solution, policy).level, VerdictLevel::kWarn);
}

TEST(Effect, AToleranceIsOfEachSensor) {
  Rig rig;
  rig.solution.poses[2].covariance(0, 0) = 1e-4;  // top: 10 mm
  Policy policy;
  policy.sensors[SensorId("top")].tolerance_m = 0.02;
  EXPECT_EQ(Assess(rig.edges, rig.solution, policy).level, VerdictLevel::kPass);
  policy.sensors[SensorId("top")].tolerance_m = 0.008;
  EXPECT_THAT(Assess(rig.edges, rig.solution, policy).why,
              HasSubstr("The pose of top is known to 10 mm and 0.057 deg only (8 mm and 0.29 deg wanted)"));
}

TEST(Effect, APairOfFewCapturesWarnsWhereThePolicyWantsMore) {
  Rig rig;
  for (int k = 0; k < 9; ++k) rig.edges[0].captures.push_back({CaptureId("c" + std::to_string(k)), 0.2, k > 0, ""});
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kPass);
  Policy policy;
  policy.captures_min = 8;
  EXPECT_EQ(Assess(rig.edges, rig.solution, policy).level, VerdictLevel::kPass) << "as many as are wanted";
  policy.captures_min = 9;
  const Verdict verdict = Assess(rig.edges, rig.solution, policy);
  EXPECT_EQ(verdict.level, VerdictLevel::kWarn);
  EXPECT_EQ(verdict.why, "left - right was measured from too few captures (8, limit 9).");
  EXPECT_EQ(verdict.what_to_do, "Take 9 captures or more of each pair.");
}

TEST(Effect, SuspectsAndTwoPosesThatAreSmallAccuseNobody) {
  Rig rig;
  rig.solution.suspects.judged = true;
  SuspectEdge suspect;
  suspect.edge = rig.edges[1].id, suspect.frame_a = rig.edges[1].frame_a, suspect.frame_b = rig.edges[1].frame_b;
  suspect.e[tangent::kX] = 0.0009;
  suspect.statistic = 100, suspect.limit = 25;
  rig.solution.suspects.edges = {suspect};
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kPass);
  EXPECT_THAT(rig.Judge().why, HasSubstr("right and top differ by 0.9 mm and 0 deg, more than chance"));
  TwoPoses two;
  two.sensor = SensorId("top");
  two.group_a = {rig.edges[1].id}, two.group_b = {rig.edges[2].id};
  two.difference[tangent::kX] = 0.0008;
  rig.solution.suspects = {true, {}, {two}};
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kPass);
  EXPECT_THAT(rig.Judge().why, HasSubstr("Two poses of top differ by 0.8 mm and 0 deg"));
  rig.solution.suspects.two_poses[0].difference[tangent::kX] = 0.002;
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kFail);
}

TEST(Effect, ACostBeyondChanceOfEdgesThatAllAgreeFailsNothing) {
  Rig rig;
  rig.solution.cost = 100.0;
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kFail);
  rig.solution.influences = OffBy(0.0009, 0.0, 0.1).solution.influences;
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kPass);
  EXPECT_THAT(rig.Judge().why,
              HasSubstr("The loops of edges are open by more than chance, but none by more than 1 mm and 0.05 deg."));
  rig.solution.influences.edges[1].off[tangent::kY] = 0.0011;
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kFail);
}

TEST(Effect, AMoveFailsFromTheLeastMoveOn) {
  const Rig rig;
  SessionEstimate session;
  session.session = SessionId(std::string(64, '2'));
  SensorMovedWithin moved;
  moved.sensor = SensorId("right"), moved.last_before = CaptureId("019"), moved.first_after = CaptureId("020");
  moved.step[tangent::kX] = 0.002;
  moved.step[tangent::kRz] = 0.2 * kDegree_rad;
  session.moved = {moved};
  session.poses = {{SensorId("right"), Se3(), 0.0}};
  EXPECT_EQ(Assess(rig.edges, rig.solution, {}, {}, {session}).level, VerdictLevel::kFail);
  Policy policy;
  policy.all.moved_min_m = 0.002;
  EXPECT_EQ(Assess(rig.edges, rig.solution, policy, {}, {session}).level, VerdictLevel::kFail) << "it was turned";
  policy.all.moved_min_rad = 0.21 * kDegree_rad;
  const Verdict small = Assess(rig.edges, rig.solution, policy, {}, {session});
  EXPECT_EQ(small.level, VerdictLevel::kPass);
  EXPECT_THAT(small.why,
              HasSubstr("right was moved during the session of 222222222222, between captures 019 and 020, by 2 "
                        "mm and 0.2 deg, within 2 mm and 0.21 deg."));
}

TEST(Effect, AMoveBetweenSessionsLikewise) {
  Rig rig;
  SensorMovedBetween moved{
      SensorId("right"), SessionId(std::string(64, '1')), SessionId(std::string(64, '2')), {}, 1e-9};
  moved.step << 0.0015, 0, 0, 0, 0, 0;
  rig.solution.fused.moved = {moved};
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kFail);
  Policy policy;
  policy.sensors[SensorId("right")].moved_min_m = 0.0015;
  const Verdict small = Assess(rig.edges, rig.solution, policy);
  EXPECT_EQ(small.level, VerdictLevel::kPass);
  EXPECT_THAT(small.why, HasSubstr("by 1.5 mm and 0 deg, within 1.5 mm and 0.05 deg."));
}

}  // namespace
}  // namespace rigcal::fleet
