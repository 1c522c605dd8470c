// Whom a verdict accuses, whom it does not rely on and the figure that decided it, beside its sentences.
#include <gmock/gmock.h>

#include "tests/unit/fleet/rig.h"

namespace rigcal::fleet {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

const SensorId kLeft("left"), kRight("right"), kTop("top");

Judgement JudgementOf(const Rig& rig) { return Judge(rig.edges, rig.solution); }

// The edge `at` is rejected by the optimum of all others, and says `off_m` more.
SuspectEdge SuspectOf(const Edge& edge, double off_m) {
  SuspectEdge suspect;
  suspect.edge = edge.id;
  suspect.frame_a = edge.frame_a, suspect.frame_b = edge.frame_b;
  suspect.statistic = 400.0, suspect.limit = 20.0;
  suspect.e(tangent::kY) = off_m;
  return suspect;
}

TEST(VerdictBasis, AnOpenLoopAccusesNobodyAndSaysByHowMuchItIsOpen) {
  Rig rig;
  rig.solution.suspects.edges = {SuspectOf(rig.edges[1], 0.02)};
  rig.solution.suspects.edges[0].alternatives = {rig.edges[0].id, rig.edges[2].id};
  const Judgement judged = JudgementOf(rig);
  ASSERT_EQ(judged.verdict.level, VerdictLevel::kFail);
  EXPECT_THAT(judged.basis.culprits, IsEmpty());
  EXPECT_EQ(judged.basis.decided_by,
            (DecidingFigure{"Loop open by", "20 mm", "limit 1 mm: right - top, left - right and left - top"}));
}

TEST(VerdictBasis, OfEdgesThatDoNotFitTheSensorThatTheyShareIsAccused) {
  Rig rig;
  rig.solution.suspects.edges = {SuspectOf(rig.edges[1], 0.02), SuspectOf(rig.edges[2], 0.01)};
  const Judgement judged = JudgementOf(rig);
  EXPECT_THAT(judged.verdict.why, HasSubstr("top does not fit"));
  EXPECT_THAT(judged.basis.culprits, ElementsAre(kTop));
  EXPECT_EQ(judged.basis.decided_by, (DecidingFigure{"top off by", "20 mm", "limit 1 mm"}));
}

TEST(VerdictBasis, AllWhomAFailingVerdictNamesAreAccused) {
  Rig rig;
  rig.edges.push_back(MakeEdge('d', "back", "low"));
  rig.solution.suspects.edges = {SuspectOf(rig.edges[0], 0.02), SuspectOf(rig.edges[3], 0.01)};
  const Judgement judged = JudgementOf(rig);
  ASSERT_THAT(judged.verdict.why, HasSubstr("left - right and back - low do not fit"));
  EXPECT_THAT(judged.basis.culprits, testing::UnorderedElementsAre(kLeft, kRight, SensorId("back"), SensorId("low")));
}

// One has no pose, another one that is too uncertain: neither is relied on.
TEST(VerdictBasis, AVerdictThatIsNotVerifiedNamesAllThatAreNotReliedOn) {
  Rig rig;
  rig.edges.push_back(FailedEdge('d', "left", "back"));
  rig.solution.poses.push_back(PoseOf("back", false));
  rig.solution.poses[2].covariance.topLeftCorner<3, 3>() *= 400.0;
  const Judgement judged = JudgementOf(rig);
  ASSERT_EQ(judged.verdict.level, VerdictLevel::kUnknown);
  EXPECT_THAT(judged.basis.doubted, ElementsAre(SensorId("back"), kTop));
  EXPECT_EQ(judged.verdict.unverified, "back and top");
}

TEST(VerdictBasis, WhatIsLessCertainThanWantedIsNotReliedOn) {
  Rig rig;
  rig.solution.poses[2].covariance.topLeftCorner<3, 3>() *= 400.0;
  const Judgement judged = JudgementOf(rig);
  ASSERT_EQ(judged.verdict.level, VerdictLevel::kUnknown);
  EXPECT_THAT(judged.basis.doubted, ElementsAre(kTop));
  EXPECT_EQ(judged.basis.decided_by, (DecidingFigure{"Pose of top known to", "20 mm", "limit 5 mm"}));
}

TEST(VerdictBasis, APassAccusesNobody) {
  Rig rig;
  for (EdgeResidual& residual : rig.solution.residuals) residual.e.setZero();
  const Judgement judged = JudgementOf(rig);
  ASSERT_EQ(judged.verdict.level, VerdictLevel::kPass);
  EXPECT_TRUE(judged.basis.empty());
}

TEST(VerdictBasis, SeveralReasonsAreSentencesOfTheirOwn) {
  Rig rig;
  rig.edges.push_back(FailedEdge('d', "left", "back"));
  rig.edges.push_back(FailedEdge('e', "right", "left_back"));
  rig.solution.dof = 0;
  rig.solution.poses.push_back(PoseOf("back"));
  rig.solution.poses.push_back(PoseOf("left_back"));
  const Judgement judged = JudgementOf(rig);
  ASSERT_THAT(judged.verdict.why, HasSubstr("; also, no loop of edges"));
  ASSERT_THAT(judged.basis.reasons, SizeIs(2));
  EXPECT_EQ(judged.basis.reasons[1].why, "No loop of edges checks the result.");
  EXPECT_THAT(judged.basis.reasons[1].what_to_do, testing::StartsWith("Calibrate one more pair"));
  EXPECT_THAT(judged.basis.culprits, IsEmpty()) << "two pairs without a sensor in common";
}

// Every edge is checked by the others, which say 20 mm more.
void EachDiffersBy20mm(Rig& rig) {
  rig.solution.influences.judged = true;
  for (const Edge& edge : rig.edges) {
    EdgeInfluence influence;
    influence.edge = edge.id;
    influence.checked = true;
    influence.off(tangent::kY) = 0.02;
    rig.solution.influences.edges.push_back(influence);
  }
}

// One of three measurements is so weak that the loop closes to it whatever the others say.
TEST(VerdictBasis, AWeakLoopAsksForItsWeakestPair) {
  Rig rig;
  Matrix6d weak = 1e6 * Matrix6d::Identity();
  weak.topLeftCorner<3, 3>() *= 1e-4;
  rig.edges[1].uncertainty = FromInformation(weak, UncertaintySource::kGiven, 0);
  EachDiffersBy20mm(rig);
  for (EdgeResidual& residual : rig.solution.residuals) residual.e.setZero();
  const Judgement judged = JudgementOf(rig);
  ASSERT_EQ(judged.verdict.level, VerdictLevel::kWarn);
  EXPECT_EQ(judged.verdict.why, "left - right and left - top are not checked: right - top is known to 100 mm only.");
  EXPECT_EQ(judged.verdict.what_to_do, "Measure right and top again.");
  EXPECT_THAT(judged.basis.culprits, ElementsAre(kRight, kTop));
}

TEST(VerdictBasis, OfPairsThatAreAllAsWeakNoneIsTheWeakest) {
  Rig rig;
  for (Edge& edge : rig.edges)
    edge.uncertainty = FromInformation(5e3 * Matrix6d::Identity(), UncertaintySource::kGiven, 0);
  EachDiffersBy20mm(rig);
  EXPECT_THAT(JudgementOf(rig).verdict.why, HasSubstr("differ by 20 mm"));
}

// The loop is closed by a pair that says next to nothing: whatever the others say, it fits.
TEST(VerdictBasis, OfALoopThatChecksNothingItsWeakestPairIsAskedFor) {
  Rig rig;
  Matrix6d weak = 1e6 * Matrix6d::Identity();
  weak.topLeftCorner<3, 3>() *= 1e-4;
  rig.edges[1].uncertainty = FromInformation(weak, UncertaintySource::kGiven, 0);
  for (EdgeResidual& residual : rig.solution.residuals) residual.e.setZero();
  rig.solution.influences.judged = true;
  for (const Edge& edge : rig.edges) {
    EdgeInfluence influence;
    influence.edge = edge.id;
    influence.checked = &edge == &rig.edges[1];
    rig.solution.influences.edges.push_back(influence);
  }
  CycleResidual loop;
  for (const Edge& edge : rig.edges) loop.edges.push_back(edge.id);
  rig.solution.cycles.worst = {loop};
  const Judgement judged = JudgementOf(rig);
  EXPECT_EQ(judged.verdict.why, "left - right and left - top are not checked: right - top is known to 100 mm only.");
  EXPECT_THAT(judged.basis.culprits, ElementsAre(kRight, kTop));
}

}  // namespace
}  // namespace rigcal::fleet
