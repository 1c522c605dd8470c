#include <gmock/gmock.h>

#include "server/fleet/assess.h"
#include "server/math/statistics.h"
#include "server/model/edges/merged_edge.h"
#include "tests/unit/fleet/rig.h"

namespace rigcal::fleet {
namespace {

using testing::HasSubstr;
using testing::Not;

struct SuspectedRig : Rig {
  SuspectedRig() { solution.suspects.judged = true; }
  void Suspect(std::size_t k, double off_m) {
    SuspectEdge suspect;
    suspect.edge = edges[k].id, suspect.frame_a = edges[k].frame_a, suspect.frame_b = edges[k].frame_b;
    suspect.e(0) = off_m;
    suspect.statistic = 100.0 * off_m * off_m / 1e-4, suspect.limit = 25.0;
    solution.suspects.edges.push_back(suspect);
  }
};

TEST(AssessSuspects, NamesTheEdgeAndByHowMuchItIsOff) {
  SuspectedRig rig;
  rig.Suspect(1, 0.02);
  const Verdict verdict = rig.Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kFail);
  EXPECT_EQ(verdict.why, "right - top does not fit the other pairs: 20 mm, 0 deg off (limit 1 mm and 0.05 deg).");
  EXPECT_EQ(verdict.what_to_do,
            "Measure right - top again, or take it out: `rigcal retire bbbbbbbbbbbbbbbb --reason \"WHY\"`.");
}

// Nobody pushed a merged edge: what is wrong of it is retired by what it stands for.
TEST(AssessSuspects, AMergedEdgeIsTakenOutByWhatItStandsFor) {
  SuspectedRig rig;
  rig.edges[1].robot = RobotId("r");
  rig.edges[1].figures.emplace(kMergedEdges, 22);
  rig.Suspect(1, 0.02);
  EXPECT_EQ(rig.Judge().what_to_do,
            "Measure right - top again, or take it out: it stands for 22 earlier edges; `rigcal edges r --in "
            "bbbbbbbbbbbbbbbb` lists what to retire of these.");
  rig.Suspect(0, 0.01);
  EXPECT_THAT(rig.Judge().what_to_do,
              HasSubstr("take these pairs out, the worst first: it stands for 22 earlier edges; `rigcal edges r --in"));
}

// A sensor is asked about only where something was measured before and after.
TEST(AssessSuspects, OnlyWhatTwoSessionsTellMayHaveBeenMoved) {
  SuspectedRig rig;
  rig.Suspect(1, 0.02);
  rig.edges[1].session = SessionId(std::string(64, '1'));
  EXPECT_THAT(rig.Judge().why, Not(HasSubstr("moved"))) << "pushed edges have no folder and no visit";
  rig.edges[2].session = SessionId(std::string(64, '2'));
  EXPECT_THAT(rig.Judge().why,
              HasSubstr("right and top do not fit the other measurements: 20 mm, 0 deg off; one may have been moved"));
  EXPECT_THAT(rig.Judge().what_to_do, HasSubstr("Was right or top moved? Yes: `rigcal push FOLDER --remounted right`"));
}

TEST(AssessSuspects, NamesTheSensorThatAllOfThemHave) {
  SuspectedRig rig;
  rig.Suspect(0, 0.02);
  rig.Suspect(2, 0.03);
  const Verdict verdict = rig.Judge();
  EXPECT_EQ(verdict.why, "left does not fit the other measurements: 30 mm, 0 deg off at worst, against right and top.");
  EXPECT_EQ(verdict.what_to_do,
            "Measure left against right and top again, or take these pairs out, the worst first: `rigcal retire "
            "cccccccccccccccc --reason \"WHY\"`.");
  for (std::size_t k = 0; k < 2; ++k) rig.edges[k].session = SessionId(std::string(64, k == 0 ? '1' : '2'));
  rig.edges[2].session = rig.edges[1].session;
  EXPECT_THAT(rig.Judge().why, HasSubstr("against right and top; it may have been moved."));
  EXPECT_THAT(rig.Judge().what_to_do, HasSubstr("Was left moved? Yes: `rigcal push FOLDER --remounted left`"));
}

TEST(AssessSuspects, NamesTheWorstFirst) {
  SuspectedRig rig;
  rig.Suspect(1, 0.02);
  rig.Suspect(2, 0.03);
  rig.solution.suspects.edges[1].frame_b = SensorId("rear");
  EXPECT_EQ(rig.Judge().why,
            "left - rear and right - top do not fit the other measurements: 30 mm, 0 deg off at worst.");
  for (std::size_t k = 0; k < 2; ++k) rig.edges[k].session = SessionId(std::string(64, k == 0 ? '1' : '2'));
  EXPECT_THAT(rig.Judge().why, HasSubstr("at worst; sensors may have been moved."));
  EXPECT_THAT(rig.Judge().what_to_do,
              HasSubstr("Was left or rear moved? Yes: `rigcal push FOLDER --remounted left`, or "
                        "rear."));
}

TEST(AssessSuspects, ALoopIsNamedWhole) {
  SuspectedRig rig;
  rig.Suspect(1, 0.02);
  rig.solution.suspects.edges[0].alternatives = {rig.edges[0].id, rig.edges[2].id};
  const Verdict verdict = rig.Judge();
  EXPECT_THAT(verdict.why,
              HasSubstr("The loop of edges right - top, left - right and left - top does not close: 20 mm, "
                        "0 deg off, and one of them is wrong"));
}

TEST(AssessSuspects, TwoPosesTakeNoSide) {
  SuspectedRig rig;
  TwoPoses two;
  two.sensor = SensorId("top");
  two.group_a = {rig.edges[1].id}, two.group_b = {rig.edges[2].id};
  two.difference << 0.04, 0, 0, 0, 0, 0;
  rig.solution.suspects.two_poses.push_back(two);
  const Verdict verdict = rig.Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kFail);
  EXPECT_THAT(verdict.why, HasSubstr("top has two poses, 40 mm and 0 deg apart: edge right - top agrees on one, "
                                     "edge left - top on the other"));
  rig.edges[1].session = SessionId(std::string(64, 'a')), rig.edges[2].session = SessionId(std::string(64, 'b'));
  EXPECT_THAT(rig.Judge().why, HasSubstr("0 deg apart: 1 edge of session aaaaaaaaaaaa agrees on one, "
                                         "1 edge of session bbbbbbbbbbbb on the other"));
  const std::int64_t minute_ns = 60'000'000'000;
  SessionTimes times = {{rig.edges[1].session, *ParseIso("2026-01-31T00:00:00Z")},
                        {rig.edges[2].session, *ParseIso("2026-02-01T09:30:10Z")}};
  EXPECT_THAT(Assess(rig.edges, rig.solution, {}, times).why,
              HasSubstr("1 edge of session 2026-01-31 agrees on one, 1 edge of session 2026-02-01 09:30 UTC on"));
  times[SessionId(std::string(64, 'c'))] = Stamp{times[rig.edges[2].session].ns + minute_ns / 2};
  EXPECT_THAT(Assess(rig.edges, rig.solution, {}, times).why,
              HasSubstr("2026-02-01 09:30 UTC (bbbbbbbbbbbb) on the other"));
}

// What helps depends on where the edges come from.
TEST(AssessSuspects, TwoPosesAreSettledByWhatTellsThemApart) {
  SuspectedRig rig;
  TwoPoses two;
  two.sensor = SensorId("top");
  two.group_a = {rig.edges[1].id}, two.group_b = {rig.edges[2].id};
  two.difference << 0.04, 0, 0, 0, 0, 0;
  rig.solution.suspects.two_poses.push_back(two);
  rig.edges[1].session = SessionId(std::string(64, 'a'));
  rig.edges[1].robot = RobotId("x-node");
  EXPECT_EQ(rig.Judge().what_to_do,
            "Was top moved between these measurements? Yes: `rigcal epoch x-node --sensor top --reason \"WHY\"`, then "
            "push what was measured since. No: take the wrong edges out with `rigcal retire EDGE --reason \"WHY\"`.");
  rig.edges[2].session = SessionId(std::string(64, 'b'));
  EXPECT_EQ(rig.Judge().what_to_do,
            "Was top moved between these sessions? Yes: `rigcal push FOLDER --remounted top` of the later session. No: "
            "tighten its mount, capture again, then `rigcal push FOLDER --remounted top`.");
  const SessionTimes times = {{rig.edges[1].session, *ParseIso("2026-02-01T09:30:10Z")},
                              {rig.edges[2].session, *ParseIso("2026-01-31T00:00:00Z")}};
  EXPECT_THAT(Assess(rig.edges, rig.solution, {}, times).what_to_do,
              HasSubstr("Was top moved after 2026-01-31? Yes: "));
  rig.edges[0].session = rig.edges[2].session;  // too weak to tell
  rig.solution.suspects.two_poses[0].group_b.push_back(rig.edges[0].id);
  EXPECT_THAT(Assess(rig.edges, rig.solution, {}, times).what_to_do,
              HasSubstr("Was top moved after 2026-01-31? Yes: "));
  rig.edges[0].session = rig.edges[1].session;  // the newest is on both sides
  EXPECT_THAT(Assess(rig.edges, rig.solution, {}, times).what_to_do,
              HasSubstr("Was top moved between these sessions?"));
  for (Edge& edge : rig.edges) edge.session = rig.edges[1].session;
  EXPECT_EQ(rig.Judge().what_to_do,
            "Was top moved during the session? Tighten its mount, capture again, "
            "then `rigcal push FOLDER --remounted top`.");
}

// Two visits that agree are newer than the one that does not: nothing is loose by now.
TEST(AssessSuspects, AnOddOldestVisitIsToBeTakenOutWhereNothingWasMoved) {
  SuspectedRig rig;
  TwoPoses two;
  two.sensor = SensorId("top");
  two.group_a = {rig.edges[1].id}, two.group_b = {rig.edges[0].id, rig.edges[2].id};
  two.difference << 0.04, 0, 0, 0, 0, 0;
  rig.solution.suspects.two_poses.push_back(two);
  for (std::size_t k = 0; k < 3; ++k) rig.edges[k].session = SessionId(std::string(64, "abc"[k]));
  SessionTimes times = {{rig.edges[1].session, *ParseIso("2026-01-01T00:00:00Z")},
                        {rig.edges[0].session, *ParseIso("2026-02-01T00:00:00Z")},
                        {rig.edges[2].session, *ParseIso("2026-03-01T00:00:00Z")}};
  EXPECT_EQ(Assess(rig.edges, rig.solution, {}, times).what_to_do,
            "Was top moved after 2026-01-01? Yes: `rigcal push FOLDER --remounted top` of the later session. No: the "
            "newer sessions agree without that of 2026-01-01, take it out: `rigcal retire bbbbbbbbbbbbbbbb --reason "
            "\"WHY\"`.");
  times[rig.edges[1].session] = *ParseIso("2026-04-01T00:00:00Z");
  EXPECT_THAT(Assess(rig.edges, rig.solution, {}, times).what_to_do, HasSubstr("No: tighten its mount"));
}

// The one that stands at the reference is no more to blame than the reference.
TEST(AssessSuspects, OfTwoSensorsBothAreNamedAndTheirEdgesCounted) {
  SuspectedRig rig;
  rig.edges = {MakeEdge('a', "left", "right"), MakeEdge('b', "left", "right"), MakeEdge('c', "right", "left")};
  for (std::size_t k = 0; k < 3; ++k) rig.solution.residuals[k].edge = rig.edges[k].id;
  rig.solution.poses.pop_back();
  TwoPoses two;
  two.sensor = SensorId("left");
  two.group_a = {rig.edges[0].id, rig.edges[1].id}, two.group_b = {rig.edges[2].id};
  two.difference << 0.04, 0, 0, 0, 0, 0;
  rig.solution.suspects.two_poses.push_back(two);
  EXPECT_THAT(rig.Judge().why, HasSubstr("ight and left have two poses against each other, 40 mm and 0 deg apart: 2 "
                                         "edges of left - right agree on one, edge right - left on the other"));
  EXPECT_THAT(rig.Judge().what_to_do, HasSubstr("Was right or left moved between these measurements? Yes: `rigcal "
                                                "epoch ROBOT --sensor right"));
}

TEST(AssessSuspects, SharedCapturesNeedTheHonestTestToo) {
  SuspectedRig rig;
  rig.Suspect(1, 0.02);
  for (EdgeResidual& residual : rig.solution.residuals)
    residual.by_jackknife = true, residual.rank = 6, residual.dof = 39.0, residual.t_squared = 6.0;
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kPass);
  rig.solution.residuals[0].t_squared = 200.0;
  const Verdict verdict = rig.Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kFail);
  EXPECT_THAT(verdict.why, HasSubstr("right - top does not fit"));
}

TEST(TestResidual, UsesTheJackknifeWhereThereIsOne) {
  const SuspectedRig rig;
  EdgeResidual residual = rig.solution.residuals[0];
  residual.weighted = 500.0;
  EXPECT_DOUBLE_EQ(TestResidual(rig.edges[0], residual, 1).statistic, 500.0);
  residual.by_jackknife = true, residual.t_squared = 3.0, residual.rank = 5, residual.dof = 38.2;
  const EdgeTest test = TestResidual(rig.edges[0], residual, 1);
  EXPECT_DOUBLE_EQ(test.statistic, 3.0);
  EXPECT_DOUBLE_EQ(test.limit, HotellingLimit(39, 5, 0.999));
  residual.dof = 0.0;
  EXPECT_DOUBLE_EQ(TestResidual(rig.edges[0], residual, 1).limit, ChiSquareQuantile(0.999, 5));
  residual.rank = 0;
  EXPECT_EQ(TestResidual(rig.edges[0], residual, 1).limit, 0.0);
}

}  // namespace
}  // namespace rigcal::fleet
