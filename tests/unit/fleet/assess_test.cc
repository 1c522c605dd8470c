#include "server/fleet/assess.h"

#include <gmock/gmock.h>

#include "server/math/statistics.h"
#include "server/model/edges/past.h"
#include "tests/unit/fleet/rig.h"

namespace rigcal::fleet {
namespace {

using testing::HasSubstr;
using testing::Not;

// However often a pair was measured.
TEST(Assess, APairThatCannotBeTestedIsNamedOnce) {
  Rig rig;
  rig.edges.push_back(MakeEdge('d', "left", "right"));
  rig.solution.residuals.push_back(ResidualOf(rig.edges.back(), 0.0005));
  for (const std::size_t few : {0U, 3U}) rig.edges[few].uncertainty.dof = 3;
  EXPECT_THAT(rig.Judge().why, testing::HasSubstr("few captures stand behind left - right to test"));
}

TEST(Assess, PassesWhereAllIsWell) {
  const Verdict verdict = Rig().Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kPass);
  EXPECT_EQ(verdict.why, "Every sensor is known well enough and the edges agree with each other.");
}

Edge PastEdge(char letter, const std::string& a, const std::string& b, std::string_view code) {
  Edge edge = FailedEdge(letter, a, b);
  edge.diagnoses = {{std::string(code), "it was another time", "Measure it anew."}};
  return edge;
}

TEST(Assess, PastEdgesHaveNotFailed) {
  Rig rig;
  rig.edges.push_back(PastEdge('d', "left", "right", kRemountedCode));  // measured again since
  rig.edges.push_back(PastEdge('e', "left", "rear", kSupersededCode));  // left out of the correction
  rig.solution.poses.push_back(PoseOf("rear"));
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kPass);
  rig.edges.push_back(PastEdge('f', "top", "rear", kRemountedCode));
  const Verdict verdict = rig.Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kWarn);
  EXPECT_EQ(verdict.why, "top - rear was not measured since a sensor was remounted.");
  EXPECT_THAT(verdict.what_to_do, HasSubstr("calibrates top - rear anew"));
}

// It has no pose, and nobody asks for it.
TEST(Assess, ASensorThatIsGoneIsNotMissed) {
  Rig rig;
  rig.edges.push_back(PastEdge('d', "left", "mast", kSensorRetiredCode));
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kPass);
  rig.edges.push_back(FailedEdge('e', "left", "rear"));
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kUnknown);
  EXPECT_THAT(rig.Judge().why, Not(HasSubstr("mast")));
  EXPECT_EQ(rig.Judge().unverified, "rear");
}

TEST(Assess, NothingIsKnownWhereAllIsPast) {
  const Verdict verdict = Assess({PastEdge('a', "left", "right", kRemountedCode)}, GraphSolution());
  EXPECT_EQ(verdict.level, VerdictLevel::kUnknown);
  EXPECT_THAT(verdict.why, HasSubstr("All that was calibrated is past"));
}

TEST(Assess, FailsByTheWorstEdge) {
  Rig rig;
  rig.solution.residuals[1] = ResidualOf(rig.edges[1], 0.030);
  rig.solution.residuals[2] = ResidualOf(rig.edges[2], 0.020);
  const Verdict verdict = rig.Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kFail);
  EXPECT_THAT(verdict.why, HasSubstr("right - top does not fit the other pairs: 30 mm, 0 deg off (limit 1 mm and "
                                     "0.05 deg)."));
  EXPECT_EQ(verdict.what_to_do,
            "Measure right - top again, or take it out: `rigcal retire bbbbbbbbbbbbbbbb --reason \"WHY\"`.");
  for (std::size_t k = 0; k < 2; ++k) rig.edges[k].session = SessionId(std::string(64, k == 0 ? '1' : '2'));
  EXPECT_THAT(rig.Judge().why, HasSubstr("right and top do not fit the other measurements: 30 mm, 0 deg off; one may "
                                         "have been moved."));
  EXPECT_EQ(rig.Judge().what_to_do,
            "Was right or top moved? Yes: `rigcal push FOLDER --remounted right`, or top. No: check their names, "
            "capture them again.");
}

TEST(Assess, SensorsThatNoGoodEdgeTiesAreNamed) {
  Rig rig;
  rig.edges.push_back(FailedEdge('d', "top", "lidar"));
  rig.solution.poses.push_back(PoseOf("lidar", false));
  const Verdict one = rig.Judge();
  EXPECT_EQ(one.level, VerdictLevel::kUnknown);
  EXPECT_EQ(
      one.why,
      "The pose of lidar is not known: no good edge ties it to left (top - lidar failed: 3 captures show the board).");
  EXPECT_EQ(one.what_to_do, "Take at least 10 captures.");
  EXPECT_EQ(one.unverified, "lidar");
  rig.edges.back().diagnoses.clear();
  EXPECT_EQ(rig.Judge().what_to_do, "Capture lidar together with sensors that are known.");
  rig.edges.push_back(FailedEdge('e', "arm", "lidar"));
  rig.solution.poses.push_back(PoseOf("arm", false));
  EXPECT_THAT(rig.Judge().why, HasSubstr("The poses of lidar and arm are not known: no good edge ties them"));
}

// Of a graph too large to say who is free to move, and of one whose numbers are too far apart.
TEST(Assess, WhereTheSolverCannotTellItIsQuoted) {
  Rig rig;
  rig.edges.push_back(MakeEdge('d', "top", "lidar"));
  rig.solution.poses.push_back(PoseOf("lidar", false));
  rig.solution.diagnoses.push_back({"not_judged", "the pose of sensor lidar cannot be judged", "Add edges."});
  EXPECT_EQ(rig.Judge().why, "The pose of sensor lidar cannot be judged.");
  EXPECT_EQ(rig.Judge().what_to_do, "Add edges.");
}

TEST(Assess, ASensorThatOccursOnlyInFailedEdgesIsUnknown) {
  Rig rig;
  rig.edges.push_back(FailedEdge('d', "top", "rear"));
  const Verdict verdict = rig.Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kUnknown);
  EXPECT_THAT(verdict.why, HasSubstr("rear"));
}

TEST(Assess, AnUnsettledGraphIsUnknown) {
  Rig rig;
  rig.solution.converged = false;
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kUnknown);
  EXPECT_THAT(rig.Judge().why, HasSubstr("did not settle"));
}

TEST(Assess, NothingOrOnlyFailuresIsUnknown) {
  EXPECT_EQ(Assess({}, {}).level, VerdictLevel::kUnknown);
  EXPECT_THAT(Assess({}, {}).why, HasSubstr("Nothing has been calibrated yet"));
  EXPECT_EQ(Assess({}, {}).unverified, "") << "all of it";
  EXPECT_THAT(Assess({FailedEdge('a', "left", "right")}, {}).why, HasSubstr("Every calibration failed"));
}

TEST(Assess, FailedEdgesWarnWithTheirCureUnlessRepaired) {
  Rig rig;
  rig.solution.poses.push_back(PoseOf("rear"));
  rig.edges.push_back(FailedEdge('d', "top", "rear"));
  const Verdict verdict = rig.Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kWarn);
  EXPECT_EQ(verdict.why, "The calibration of top - rear failed.");
  EXPECT_EQ(verdict.what_to_do, "Take at least 10 captures.");
  rig.edges.push_back(MakeEdge('e', "rear", "top"));
  EXPECT_EQ(rig.Judge().why, "Nothing checks the pose of rear: a single edge is the only tie to the reference.");
  rig.edges.push_back(MakeEdge('f', "rear", "left"));
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kPass);
}

TEST(Assess, UncertainSensorsAreNotToBeReliedOnWhateverTheAxis) {
  for (int axis = 0; axis < 6; ++axis) {
    Rig rig;
    rig.solution.poses[2].covariance(axis, axis) = 1e-4;
    const Verdict verdict = rig.Judge();
    EXPECT_EQ(verdict.level, VerdictLevel::kUnknown) << axis;
    EXPECT_EQ(verdict.unverified, axis < 3 ? "top (10 mm, limit 5 mm)" : "top (0.57 deg, limit 0.29 deg)");
    EXPECT_EQ(verdict.why, axis < 3 ? "The pose of top is known to 10 mm and 0.057 deg only (5 mm and 0.29 deg wanted)."
                                    : "The pose of top is known to 1 mm and 0.57 deg only (5 mm and 0.29 deg wanted).");
    EXPECT_EQ(verdict.what_to_do, "Capture top at more distances and tilts.");
  }
}

// Though each of its sensors is known well enough.
TEST(Assess, APairThatIsKnownToLessThanItsToleranceWarns) {
  const Rig rig;
  const SensorPair pair{SensorId("left"), SensorId("right")}, other{SensorId("right"), SensorId("top")};
  Policy policy;
  policy.pairs[pair].tolerance_m = 0.002, policy.pairs[pair].tolerance_rad = 0.05 * M_PI / 180;
  policy.pairs[other].tolerance_m = 0.003;
  Matrix6d covariance = 1e-8 * Matrix6d::Identity();
  PairCovariances known = {{pair, covariance}, {other, covariance}};
  const auto judge = [&] { return Assess(rig.edges, rig.solution, policy, {}, {}, {}, {known, {}}); };
  EXPECT_EQ(judge().level, VerdictLevel::kPass) << judge().why;
  known[pair](tangent::kZ, tangent::kZ) = 0.0033 * 0.0033;
  known[pair](tangent::kRy, tangent::kRy) = std::pow(0.094 * M_PI / 180, 2);
  EXPECT_EQ(judge().level, VerdictLevel::kWarn);
  EXPECT_EQ(judge().why, "left - right is known to 3.3 mm and 0.094 deg only (2 mm and 0.05 deg wanted).");
  EXPECT_EQ(judge().what_to_do, "Capture left and right together at more distances and tilts.");
  known[other](tangent::kX, tangent::kX) = 0.02 * 0.02;
  EXPECT_THAT(judge().why, HasSubstr("right - top and left - right are known, at worst, to 20 mm"));
  EXPECT_THAT(judge().why, HasSubstr("(3 mm and 0.29 deg wanted)"));
  policy.pairs.clear();
  policy.pairs[pair].moved_min_m = 0.002;
  EXPECT_EQ(judge().level, VerdictLevel::kPass) << "no tolerance is said of it";
}

// An edge that was pushed has no captures: it tells by what its covariance was estimated from, if it was.
TEST(Assess, APairOfFewerCapturesThanThePolicyWantsWarns) {
  Rig rig;
  Policy policy;
  policy.captures_min = 20;
  const auto judge = [&] { return Assess(rig.edges, rig.solution, policy); };
  EXPECT_EQ(judge().level, VerdictLevel::kPass) << "known exactly";
  rig.edges[0].uncertainty.dof = 18;
  EXPECT_EQ(judge().level, VerdictLevel::kWarn);
  EXPECT_THAT(judge().why, HasSubstr("left - right was measured from too few captures (19, limit 20)"));
  rig.edges[0].uncertainty.dof = 19;
  EXPECT_EQ(judge().level, VerdictLevel::kPass) << judge().why;
  rig.edges[2].uncertainty.blocks.resize(19);
  EXPECT_THAT(judge().why, HasSubstr("left - top was measured from too few captures (19, limit 20)"));
  rig.edges[2].session = SessionId(std::string(64, '1'));
  EXPECT_EQ(judge().level, VerdictLevel::kPass) << "of two pose streams: its blocks are no captures";
  for (int i = 0; i < 19; ++i) rig.edges[2].captures.push_back({CaptureId(std::to_string(i)), 0.0, true, ""});
  rig.edges[2].captures.push_back({CaptureId("unused"), 0.0, false, ""});
  EXPECT_THAT(judge().why, HasSubstr("left - top was measured from too few captures (19, limit 20)"));
}

TEST(Assess, AGraphWithoutALoopWarns) {
  Rig rig;
  rig.solution.dof = 0;
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kWarn);
  EXPECT_EQ(rig.Judge().why, "No loop of edges checks the result.");
}

TEST(Assess, SeveralWarningsAreAllNamedInOneSentence) {
  Rig rig;
  rig.solution.dof = 0;
  rig.solution.poses[1].covariance(0, 0) = 1e-4;
  const Verdict verdict = rig.Judge();
  EXPECT_THAT(verdict.why, HasSubstr("right"));
  EXPECT_THAT(verdict.why, HasSubstr("; also, no loop"));
  EXPECT_EQ(std::count(verdict.why.begin(), verdict.why.end(), '\n'), 0);
}

TEST(Assess, TheWorstLevelWins) {
  Rig rig;
  rig.solution.dof = 0;
  rig.solution.poses.push_back(PoseOf("lidar", false));
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kUnknown);
  rig.solution.residuals[0] = ResidualOf(rig.edges[0], 0.05);
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kFail);
}

TEST(Assess, ManySensorsAreCounted) {
  Rig rig;
  for (int k = 0; k < 9; ++k) rig.solution.poses.push_back(PoseOf("s" + std::to_string(k), false));
  EXPECT_THAT(rig.Judge().why, HasSubstr("s0, s1, s2, s3, s4, s5 and 3 more"));
}

TEST(TestResidual, UsesChiSquareForKnownAndHotellingForEstimatedCovariance) {
  Policy policy;
  policy.residual_probability = 0.95;
  const Edge known = MakeEdge('a', "left", "right"), estimated = MakeEdge('b', "left", "right", 39);
  const EdgeTest chi_square = TestResidual(known, ResidualOf(known, 0.002), 1, policy);
  EXPECT_NEAR(chi_square.statistic, 4.0, 1e-12);
  EXPECT_NEAR(chi_square.limit, 12.592, 1e-3);  // table of chi-square, 6 degrees of freedom
  EXPECT_NEAR(TestResidual(estimated, ResidualOf(estimated, 0.002), 1, policy).limit, 16.4, 0.05);  // design, m = 40
}

TEST(TestResidual, CorrectsForTheNumberOfEdges) {
  const Edge edge = MakeEdge('a', "left", "right");
  const EdgeTest one = TestResidual(edge, ResidualOf(edge, 0.0), 1),
                 hundred = TestResidual(edge, ResidualOf(edge, 0.0), 100);
  EXPECT_NEAR(ChiSquareTail(one.limit, 6), 1e-3, 1e-9);
  EXPECT_NEAR(ChiSquareTail(hundred.limit, 6), 1e-5, 1e-9);
}

TEST(TestResidual, JudgesNothingFromTooFewBlocksOrOutsideTheSolution) {
  const Edge few = MakeEdge('a', "left", "right", 4);
  EXPECT_EQ(TestResidual(few, ResidualOf(few, 0.1), 1).limit, 0.0);
  const Edge edge = MakeEdge('b', "left", "right");
  EdgeResidual outside = ResidualOf(edge, 0.1);
  outside.in_solution = false;
  EXPECT_EQ(TestResidual(edge, outside, 1).limit, 0.0);
}

TEST(TestResidual, CountsOnlyTheDirectionsAnEdgeSees) {
  Edge edge = MakeEdge('a', "left", "right");
  Matrix6d Omega = edge.uncertainty.Omega;
  Omega(2, 2) = 0.0;
  edge.uncertainty = FromInformation(Omega, UncertaintySource::kGiven, 0);
  Policy policy;
  policy.residual_probability = 0.95;
  EXPECT_NEAR(TestResidual(edge, ResidualOf(edge, 0.001), 1, policy).limit, 11.070, 1e-3);  // 5 degrees of freedom
}

Edge OpenEdge(char letter, const std::string& a, const std::string& b, const std::string& code) {
  Edge edge = MakeEdge(letter, a, b);
  Matrix6d Omega = edge.uncertainty.Omega;
  Omega(tangent::kZ, tangent::kZ) = 0.0;
  edge.uncertainty = FromInformation(Omega, UncertaintySource::kGiven, 0);
  edge.diagnoses.push_back({code, "how far is not known", "Use ramps for " + code + "."});
  return edge;
}

SensorPose OpenPose(const std::string& name) {
  SensorPose pose = PoseOf(name, false);
  pose.unobservable_basis = {Vector6d::Unit(tangent::kZ)};
  pose.measured_part = MeasuredPart{};
  pose.measured_part->covariance =
      2e-6 * (Matrix6d::Identity() - pose.unobservable_basis[0] * pose.unobservable_basis[0].transpose());
  return pose;
}

TEST(Assess, ADirectionThatTheMotionLeavesOpenIsToldByTheMotion) {
  Rig rig;
  rig.edges.push_back(OpenEdge('d', "left", "rear", "pure_translation"));
  rig.edges.push_back(OpenEdge('e', "right", "rear", "planar_motion"));
  rig.edges.push_back(OpenEdge('f', "top", "arm", "planar_motion"));
  rig.solution.poses.push_back(OpenPose("rear"));
  rig.solution.poses.push_back(OpenPose("arm"));
  const Verdict verdict = rig.Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kUnknown);
  EXPECT_EQ(verdict.why,
            "The position along z of rear and arm in the frame of left was not measured, as the robot was turned about "
            "one axis only; the rest was, to 1.4 mm and 0.081 deg.");
  EXPECT_EQ(verdict.what_to_do, "Use ramps for planar_motion.");
  rig.edges.push_back(FailedEdge('g', "top", "lidar"));
  rig.solution.poses.push_back(PoseOf("lidar", false));
  EXPECT_THAT(
      rig.Judge().why,
      HasSubstr("0.081 deg; also, the pose of lidar is not known: no good edge ties it to left (top - lidar failed"));
}

TEST(Assess, ASensorThatWasMovedDuringASessionFailsTheRobotByName) {
  const Rig rig;
  SessionEstimate clean, bumped;
  clean.session = SessionId(std::string(64, '1'));
  bumped.session = SessionId(std::string(64, '2'));
  SensorMovedWithin moved;
  moved.sensor = SensorId("right");
  moved.last_before = CaptureId("019"), moved.first_after = CaptureId("020");
  moved.step[tangent::kX] = 0.02;
  moved.step[tangent::kRz] = 0.0349;
  bumped.moved = {moved};
  bumped.poses = {{SensorId("right"), Se3(), 0.0}};
  const SessionTimes captured_at = {{bumped.session, ParseIso("2026-01-31T12:00:00Z").value()}};
  EXPECT_EQ(Assess(rig.edges, rig.solution, {}, captured_at, {clean}).level, VerdictLevel::kPass);
  const Verdict verdict = Assess(rig.edges, rig.solution, {}, captured_at, {clean, bumped});
  EXPECT_EQ(verdict.level, VerdictLevel::kFail);
  EXPECT_EQ(verdict.why,
            "right was moved during the session of 2026-01-31 12:00 UTC, between captures 019 and 020, by 20 mm and 2 "
            "deg.");
  EXPECT_EQ(verdict.what_to_do,
            "Tighten the mount of right, capture again, then `rigcal push FOLDER --remounted right`.");
}

// Of one that took no part in the refinement pairs tell it.
TEST(Assess, AMoveThatPairsTellIsRough) {
  const Rig rig;
  SessionEstimate refined;
  refined.session = SessionId(std::string(64, '2'));
  refined.poses = {{SensorId("left"), Se3(), 0.0}};
  refined.moved = {{SensorId("right"), CaptureId("019"), CaptureId("020"), Vector6d::Unit(tangent::kX) * 0.02}};
  EXPECT_NE(Assess(rig.edges, rig.solution, {}, {}, {refined}).why.find(", by roughly 20 mm"), std::string::npos);
}

TEST(Assess, ASensorThatWasMovedBetweenSessionsIsMadePastWhicheverTheAnswer) {
  Rig rig;
  const SessionId first(std::string(64, '1')), second(std::string(64, '2'));
  SensorMovedBetween moved{SensorId("right"), first, second};
  moved.step[tangent::kX] = 0.008;
  rig.solution.fused.moved = {moved};
  const SessionTimes captured_at = {{first, ParseIso("2026-01-31").value()}, {second, ParseIso("2026-02-03").value()}};
  const auto judge = [&] { return Assess(rig.edges, rig.solution, {}, captured_at); };
  EXPECT_EQ(judge().level, VerdictLevel::kFail);
  EXPECT_EQ(judge().what_to_do,
            "Was right moved after 2026-01-31? Yes: `rigcal push FOLDER --remounted right` of the session of "
            "2026-02-03. No: tighten the mount, capture again, then `rigcal push FOLDER --remounted right`.");
  moved.sensor = SensorId("top");
  rig.solution.fused.moved.push_back(moved);
  EXPECT_THAT(judge().what_to_do, HasSubstr("Were right and top moved after 2026-01-31?"));
  EXPECT_THAT(judge().what_to_do, HasSubstr("No: tighten the mount, capture again, then `rigcal push FOLDER "
                                            "--remounted right,top`"));
}

TEST(Assess, ALensThatChangedIsNoMount) {
  const Rig rig;
  SessionEstimate refocused;
  refocused.session = SessionId(std::string(64, '2'));
  SensorMovedWithin moved;
  moved.sensor = SensorId("right");
  moved.last_before = CaptureId("019"), moved.first_after = CaptureId("020");
  moved.step[tangent::kZ] = 0.007;
  moved.lens = {-0.003, 1e-5, true};
  refocused.moved = {moved};
  refocused.poses = {{SensorId("right"), Se3(), 0.0}};
  const SessionTimes captured_at = {{refocused.session, ParseIso("2026-01-31T12:00:00Z").value()}};
  const Verdict surely = Assess(rig.edges, rig.solution, {}, captured_at, {refocused});
  EXPECT_EQ(surely.level, VerdictLevel::kFail);
  EXPECT_EQ(
      surely.why,
      "The lens of right changed during the session of 2026-01-31 12:00 UTC, between captures 019 and 020: its focal "
      "length is 0.3 % shorter.");
  EXPECT_EQ(surely.what_to_do,
            "Lock focus and zoom of right, take new intrinsics or leave them out of session.yaml, capture again, then "
            "`rigcal push FOLDER --remounted right`.");
  refocused.moved[0].lens->surely = false;
  const Verdict either = Assess(rig.edges, rig.solution, {}, captured_at, {refocused});
  EXPECT_EQ(either.level, VerdictLevel::kFail);
  EXPECT_EQ(either.why,
            "right was moved during the session of 2026-01-31 12:00 UTC, between captures 019 and 020, by 7 mm and 0 "
            "deg, or its "
            "lens changed (its focal length is 0.3 % shorter).");
  EXPECT_EQ(either.what_to_do,
            "Lock focus and zoom of right, take new intrinsics or leave them out of session.yaml, tighten the mount of "
            "right, capture again, then `rigcal push FOLDER --remounted right`.");
}

}  // namespace
}  // namespace rigcal::fleet
