#include <gmock/gmock.h>

#include "server/fleet/assess.h"
#include "server/math/statistics.h"
#include "server/model/past.h"

namespace rigcal::fleet {
namespace {

using testing::HasSubstr;
using testing::Not;

Edge MakeEdge(char letter, const std::string& a, const std::string& b, int dof = 0) {
  Edge edge;
  edge.id = EdgeId(std::string(64, letter));
  edge.frame_a = SensorId(a), edge.frame_b = SensorId(b);
  edge.uncertainty = FromInformation(1e6 * Matrix6d::Identity(), UncertaintySource::kGiven, dof);
  edge.state = EdgeState::kGood;
  return edge;
}

Edge FailedEdge(char letter, const std::string& a, const std::string& b) {
  Edge edge = MakeEdge(letter, a, b);
  edge.state = EdgeState::kFailed;
  edge.diagnoses.push_back({"too_few_captures", "3 captures show the board", "Take at least 10 captures."});
  return edge;
}

EdgeResidual ResidualOf(const Edge& edge, double off_m) {
  EdgeResidual residual;
  residual.edge = edge.id;
  residual.in_solution = true;
  residual.e(tangent::kY) = off_m;
  residual.weighted = residual.e.dot(edge.uncertainty.Omega * residual.e);
  return residual;
}

SensorPose PoseOf(const std::string& name, bool known = true, double variance = 1e-6) {
  SensorPose pose;
  pose.sensor = SensorId(name);
  pose.known = known;
  if (known) pose.covariance = variance * Matrix6d::Identity();
  return pose;
}

// A triangle in which all is well.
struct Rig {
  std::vector<Edge> edges = {MakeEdge('a', "left", "right"), MakeEdge('b', "right", "top"),
                             MakeEdge('c', "left", "top")};
  GraphSolution solution;
  Rig() {
    solution.converged = true;
    solution.dof = 6;
    solution.poses = {PoseOf("left", true, 0.0), PoseOf("right"), PoseOf("top")};
    for (const Edge& edge : edges) solution.residuals.push_back(ResidualOf(edge, 0.0005));
  }
  [[nodiscard]] Verdict Judge() const { return Assess(edges, solution); }
};

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
  EXPECT_EQ(verdict.why, "Top - rear was not measured since a sensor was remounted.");
  EXPECT_THAT(verdict.what_to_do, HasSubstr("calibrates top - rear anew"));
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
  EXPECT_THAT(verdict.why, HasSubstr("Edge right - top contradicts the other edges: it is off by 30 mm and 0 deg"));
  EXPECT_THAT(verdict.what_to_do, HasSubstr("right and top"));
}

TEST(Assess, UnknownSensorsAreNamedWithTheirDiagnosis) {
  Rig rig;
  rig.solution.poses.push_back(PoseOf("lidar", false));
  rig.solution.diagnoses.push_back({"not_connected",
                                    "sensor lidar is not connected to reference left: it has no good edge",
                                    "Capture a session that shows lidar."});
  const Verdict one = rig.Judge();
  EXPECT_EQ(one.level, VerdictLevel::kUnknown);
  EXPECT_EQ(one.why, "Sensor lidar is not connected to reference left: it has no good edge.");
  EXPECT_EQ(one.what_to_do, "Capture a session that shows lidar.");
  rig.solution.poses.push_back(PoseOf("arm", false));
  EXPECT_THAT(rig.Judge().why, HasSubstr("lidar and arm"));
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

TEST(Assess, UncertainSensorsWarnOnEveryAxis) {
  for (int axis = 0; axis < 6; ++axis) {
    Rig rig;
    rig.solution.poses[2].covariance(axis, axis) = 1e-4;
    const Verdict verdict = rig.Judge();
    EXPECT_EQ(verdict.level, VerdictLevel::kWarn) << axis;
    EXPECT_THAT(verdict.why, HasSubstr("The pose of top is less certain than the policy asks")) << axis;
    EXPECT_THAT(verdict.why, HasSubstr(axis < 3 ? "10 mm" : "0.573 deg"));
  }
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
            "The pose of rear and arm is known but for one direction: the robot was turned about one axis only.");
  EXPECT_EQ(verdict.what_to_do, "Use ramps for planar_motion.");
  rig.solution.poses.push_back(PoseOf("lidar", false));
  EXPECT_THAT(rig.Judge().why, HasSubstr("one axis only; no good edges tie lidar to the reference."));
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
  const SessionTimes captured_at = {{bumped.session, ParseIso("2026-01-31T12:00:00Z").value()}};
  EXPECT_EQ(Assess(rig.edges, rig.solution, {}, captured_at, {clean}).level, VerdictLevel::kPass);
  const Verdict verdict = Assess(rig.edges, rig.solution, {}, captured_at, {clean, bumped});
  EXPECT_EQ(verdict.level, VerdictLevel::kFail);
  EXPECT_EQ(verdict.why,
            "Right was moved during the session of 2026-01-31 12:00 UTC, between captures 019 and 020, by 20 mm and 2 "
            "deg.");
  EXPECT_EQ(verdict.what_to_do,
            "Tighten the mount of right, capture a new session and push it with `--remounted right`; nothing that this "
            "session says of right can be relied on.");
}

LensMisfit MisfitOf(const std::string& camera, CameraModel model, double sigma_ratio) {
  LensMisfit misfit;
  misfit.camera = SensorId(camera);
  misfit.model = model;
  misfit.rms_px = 0.0512, misfit.evidence = 300, misfit.sigma_ratio = sigma_ratio;
  misfit.pose_sigma_m = 2e-4, misfit.pose_sigma_rad = 1e-4;
  return misfit;
}

SessionEstimate BentSession(char letter, std::vector<LensMisfit> misfits) {
  SessionEstimate estimate;
  estimate.session = SessionId(std::string(64, letter));
  for (const char* sensor : {"left", "right", "top"}) estimate.poses.push_back({SensorId(sensor), {}});
  estimate.misfits = std::move(misfits);
  return estimate;
}

TEST(AssessLens, OneThatMattersWarnsByNameWithItsModel) {
  const Rig rig;
  const Verdict verdict = Assess(rig.edges, rig.solution, {}, {},
                                 {BentSession('1', {MisfitOf("right", CameraModel::kPinholeRadtan, 2.0),
                                                    MisfitOf("top", CameraModel::kPinholeRadtan, 1.4)})});
  EXPECT_EQ(verdict.level, VerdictLevel::kWarn);
  EXPECT_EQ(verdict.why,
            "The lens of right bends in a way that pinhole_radtan cannot: by 0.0512 px rms, which makes poses uncertain "
            "by 0.2 mm and 0.00573 deg.");
  EXPECT_EQ(verdict.what_to_do, "Try `model: pinhole_rational` for right.");
}

TEST(AssessLens, OneThatAddsLittleIsLeftToTheSigmas) {
  const Rig rig;
  const auto bent = BentSession('1', {MisfitOf("right", CameraModel::kPinholeRadtan, 1.4)});
  EXPECT_EQ(Assess(rig.edges, rig.solution, {}, {}, {bent}).level, VerdictLevel::kPass);
  LensMisfit tiny = MisfitOf("right", CameraModel::kPinholeRadtan, 5.0);
  tiny.pose_sigma_m = tiny.pose_sigma_rad = 2e-5;
  EXPECT_EQ(Assess(rig.edges, rig.solution, {}, {}, {BentSession('1', {tiny})}).level, VerdictLevel::kPass);
}

TEST(AssessLens, TheNewestSessionOfACameraCounts) {
  const Rig rig;
  const auto bent = BentSession('1', {MisfitOf("right", CameraModel::kPinholeRadtan, 3.0)});
  EXPECT_EQ(Assess(rig.edges, rig.solution, {}, {}, {BentSession('2', {}), bent}).level, VerdictLevel::kPass);
}

SessionEstimate SessionOfMoves(std::vector<std::pair<const char*, SmallestMove>> moves) {
  SessionEstimate estimate;
  estimate.session = SessionId(std::string(64, '1'));
  for (const auto& [sensor, move] : moves) estimate.poses.push_back({SensorId(sensor), {}, 0.0, move});
  return estimate;
}

Verdict VerdictOfMoves(std::vector<std::pair<const char*, SmallestMove>> moves) {
  const Rig rig;
  return Assess(rig.edges, rig.solution, {},
                {{SessionId(std::string(64, '1')), ParseIso("2026-01-31T12:00:00Z").value()}},
                {SessionOfMoves(std::move(moves))});
}

TEST(AssessUnseen, APassSaysWhatWouldHaveBeenNoticed) {
  const Verdict verdict = VerdictOfMoves({{"left", {0.002, 0.001, 40}}, {"right", {0.0015, 0.002, 40}}});
  EXPECT_EQ(verdict.level, VerdictLevel::kPass);
  EXPECT_THAT(
      verdict.why,
      HasSubstr(" A bump of any sensor by 2 mm or 0.115 deg half-way through a session would have been noticed."));
}

TEST(AssessUnseen, AMoveBeyondTheToleranceThatNothingWouldShowWarnsWithTheNumberOfPlaces) {
  const Verdict verdict =
      VerdictOfMoves({{"left", {0.002, 0.001, 40}}, {"right", {0.008, 0.002, 20}}, {"top", {0.006, 0.001, 20}}});
  EXPECT_EQ(verdict.level, VerdictLevel::kWarn);
  EXPECT_EQ(verdict.why,
            "A bump of any of right and top half-way through the session of 2026-01-31 12:00 UTC would not have been "
            "noticed, of right by "
            "up to 8 mm or 0.115 deg.");
  EXPECT_EQ(verdict.what_to_do, "Capture at least 52 places that right sees; it saw something in 20 captures.");
}

TEST(AssessUnseen, OneSensorIsToldWithItsSize) {
  EXPECT_EQ(VerdictOfMoves({{"right", {0.008, 0.002, 20}}}).why,
            "A bump of right by up to 8 mm or 0.115 deg half-way through the session of 2026-01-31 12:00 UTC would not "
            "have been noticed.");
}

TEST(AssessUnseen, WhereNoMoveWouldShowNoSizeIsTold) {
  const Verdict verdict = VerdictOfMoves({{"right", {kAnyMove_m, kAnyMove_rad, 5}}});
  EXPECT_EQ(verdict.level, VerdictLevel::kWarn);
  EXPECT_EQ(verdict.why,
            "A bump of right half-way through the session of 2026-01-31 12:00 UTC would not have been noticed.");
  EXPECT_EQ(verdict.what_to_do, "Capture more places that right sees; it saw something in 5 captures.");
}

TEST(AssessUnseen, TheNewestSessionOfASensorCounts) {
  const Rig rig;
  const auto blind = SessionOfMoves({{"right", {0.5, 0.5, 6}}}),
             sharp = SessionOfMoves({{"right", {0.001, 0.001, 60}}});
  EXPECT_EQ(Assess(rig.edges, rig.solution, {}, {}, {sharp, blind}).level, VerdictLevel::kPass);
  EXPECT_EQ(Assess(rig.edges, rig.solution, {}, {}, {blind, sharp}).level, VerdictLevel::kWarn);
}

TEST(AssessLens, ALensWithoutARicherModelNeedsMoreOfItsPicture) {
  const Rig rig;
  const Verdict verdict = Assess(rig.edges, rig.solution, {}, {},
                                 {BentSession('1', {MisfitOf("left", CameraModel::kFisheyeKb4, 2.0),
                                                    MisfitOf("right", CameraModel::kPinholeRadtan, 3.0)})});
  EXPECT_THAT(verdict.why, HasSubstr("The lenses of right and left bend in ways that pinhole_radtan and fisheye_kb4 cannot: "
                                     "worst is right, by"));
  EXPECT_THAT(verdict.what_to_do, HasSubstr("for right; capture boards all over the pictures of left"));
}

// A rig of one session, one of whose edges contradicts the others by so much.
Rig Contradicted(double off_m) {
  Rig rig;
  for (Edge& edge : rig.edges) edge.session = SessionId(std::string(64, '1'));
  rig.solution.residuals[0] = ResidualOf(rig.edges[0], off_m);
  return rig;
}

TEST(AssessRefined, PairsOfARefinedSessionAccuseNoSensor) {
  Rig rig = Contradicted(0.02);
  ASSERT_EQ(Assess(rig.edges, rig.solution).level, VerdictLevel::kFail);
  rig.solution.fused.sessions = {SessionId(std::string(64, '1'))};
  EXPECT_EQ(Assess(rig.edges, rig.solution).level, VerdictLevel::kPass);
  const auto bent = BentSession('1', {MisfitOf("right", CameraModel::kPinholeRadtan, 1.1)});
  const Verdict verdict = Assess(rig.edges, rig.solution, {}, {}, {bent});
  EXPECT_EQ(verdict.level, VerdictLevel::kWarn);
  EXPECT_THAT(verdict.why, HasSubstr("Pairs of sensors disagree beyond chance because the lens of right bends"));
}

TEST(AssessRefined, WhatIsGrosslyOffFailsAllTheSame) {
  Rig rig = Contradicted(0.06);
  rig.solution.fused.sessions = {SessionId(std::string(64, '1'))};
  EXPECT_EQ(Assess(rig.edges, rig.solution).level, VerdictLevel::kFail);
}

TEST(AssessRefined, AnEdgeOfAnotherSourceAccusesAllTheSame) {
  Rig rig = Contradicted(0.02);
  rig.solution.fused.sessions = {SessionId(std::string(64, '1'))};
  rig.edges[0].session = SessionId();
  EXPECT_EQ(Assess(rig.edges, rig.solution).level, VerdictLevel::kFail);
}

TEST(AssessRefined, ASensorThatMovedBetweenSessionsFails) {
  Rig rig;
  SensorMovedBetween moved{SensorId("right"), SessionId(std::string(64, '1')), SessionId(std::string(64, '2')), {}, 1e-9};
  moved.step[0] = 0.0097;
  rig.solution.fused.moved = {moved};
  const SessionTimes times = {{moved.last_before, Stamp{0}}, {moved.first_after, Stamp{86'400'000'000'000}}};
  const Verdict verdict = Assess(rig.edges, rig.solution, {}, times);
  EXPECT_EQ(verdict.level, VerdictLevel::kFail);
  EXPECT_THAT(verdict.why, HasSubstr("Right was moved between the sessions of 1970-01-01 and 1970-01-02, by 9.7 mm"));
  EXPECT_THAT(verdict.what_to_do, HasSubstr("`--remounted right`"));
}

}  // namespace
}  // namespace rigcal::fleet
