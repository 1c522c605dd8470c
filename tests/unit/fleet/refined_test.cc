// Verdicts on what the refinement of whole sessions says.
#include <gmock/gmock.h>

#include "server/model/edges/method.h"
#include "tests/unit/fleet/rig.h"

namespace rigcal::fleet {
namespace {

using testing::HasSubstr;
using testing::Not;

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
  EXPECT_EQ(
      verdict.why,
      "The lens of right bends in a way that pinhole_radtan cannot: 0.051 px, which makes poses uncertain by 0.2 mm "
      "and 0.0057 deg.");
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

// A loop that fails by more than any lens is excused for still says which lens may be behind it.
TEST(AssessLens, BesideAnOpenLoopItIsNamedToo) {
  Rig rig;
  CycleResidual loop;
  for (const char* name : {"left", "right", "top"}) loop.sensors.emplace_back(name);
  for (Edge& edge : rig.edges) {
    edge.uncertainty.dof = 39;  // estimated: the loops judge them, not the cost
    loop.edges.push_back(edge.id);
  }
  loop.e << 0.06, 0.08, 0.0, 0.0, 0.0, 0.0;
  loop.tested = true;
  loop.t_squared = 80.0, loop.limit = 40.0;
  rig.solution.cycles.judged = true;
  rig.solution.cycles.worst = {loop};
  rig.solution.cycles.failing = 1;
  EXPECT_THAT(Assess(rig.edges, rig.solution, {}, {}, {BentSession('1', {})}).why, Not(HasSubstr("lens")));
  const Verdict verdict = Assess(rig.edges, rig.solution, {}, {},
                                 {BentSession('1', {MisfitOf("right", CameraModel::kPinholeRadtan, 1.1)})});
  EXPECT_EQ(verdict.level, VerdictLevel::kFail);
  EXPECT_THAT(verdict.why, HasSubstr("does not close"));
  EXPECT_THAT(verdict.why, HasSubstr("it may be that the lens of right bends in a way that pinhole_radtan cannot"));
  EXPECT_THAT(verdict.what_to_do, HasSubstr("pinhole_rational"));
  // A lens that has no part in the loop is not behind it.
  EXPECT_THAT(
      Assess(rig.edges, rig.solution, {}, {}, {BentSession('1', {MisfitOf("back", CameraModel::kPinholeRadtan, 1.1)})})
          .why,
      Not(HasSubstr("lens")));
}

TEST(AssessLens, TheNewestSessionOfACameraCounts) {
  const Rig rig;
  const auto bent = BentSession('1', {MisfitOf("right", CameraModel::kPinholeRadtan, 3.0)});
  EXPECT_EQ(Assess(rig.edges, rig.solution, {}, {}, {BentSession('2', {}), bent}).level, VerdictLevel::kPass);
}

TEST(AssessLens, ALensWithoutARicherModelNeedsMoreOfItsPicture) {
  const Rig rig;
  const Verdict verdict = Assess(rig.edges, rig.solution, {}, {},
                                 {BentSession('1', {MisfitOf("left", CameraModel::kFisheyeKb4, 2.0),
                                                    MisfitOf("right", CameraModel::kPinholeRadtan, 3.0)})});
  EXPECT_THAT(verdict.why,
              HasSubstr("The lenses of right and left bend in ways that pinhole_radtan and fisheye_kb4 cannot: "
                        "0.051 px of right, which makes"));
  EXPECT_THAT(verdict.what_to_do, HasSubstr("for right; capture boards all over the pictures of left"));
}

Verdict VerdictOfClock(double late_s, double sigma_s) {
  const Rig rig;
  SessionEstimate session = BentSession('1', {});
  session.clocks = {{SensorId("top"), late_s, sigma_s, 0.05, 40}};
  return Assess(rig.edges, rig.solution, {}, {}, {session});
}

TEST(AssessClock, OneThatIsSurelyOffIsNewsAndNoWarning) {
  const Verdict verdict = VerdictOfClock(0.0123, 0.0004);
  EXPECT_EQ(verdict.level, VerdictLevel::kPass);
  EXPECT_THAT(verdict.why, HasSubstr("lock of top is 12.3 ms late, which was taken out"));
  EXPECT_THAT(VerdictOfClock(-0.0123, 0.0004).why, HasSubstr("12.3 ms early"));
}

TEST(AssessClock, OneThatMayBeRightOrIsOffByLittleIsNotTold) {
  EXPECT_THAT(VerdictOfClock(0.0123, 0.005).why, Not(HasSubstr("lock of")));
  EXPECT_THAT(VerdictOfClock(0.0009, 0.0001).why, Not(HasSubstr("lock of")));
}

LensMisfit TriedOn(const std::string& camera, bool given, std::optional<CameraModel> proposed) {
  LensMisfit misfit = MisfitOf(camera, CameraModel::kPinholeRadtan, 2.0);
  misfit.trial = {0.43,
                  given,
                  24,
                  {{CameraModel::kPinholeRadtan, given ? 0.25 : 0.43},
                   {CameraModel::kPinholeRational, 0.21},
                   {CameraModel::kFisheyeKb4, std::nullopt}},
                  proposed};
  return misfit;
}

Verdict VerdictOfLenses(std::vector<LensMisfit> misfits) {
  const Rig rig;
  return Assess(rig.edges, rig.solution, {}, {}, {BentSession('1', std::move(misfits))});
}

TEST(AssessLens, AModelThatForetellsBetterIsProposedWithWhatItGains) {
  EXPECT_EQ(
      VerdictOfLenses({TriedOn("right", false, CameraModel::kPinholeRational)}).what_to_do,
      "Set `model: pinhole_rational` for right (pinhole_rational fits pictures of right that were left out to 0.21 px, "
      "pinhole_radtan to 0.43 px).");
}

TEST(AssessLens, OfGivenIntrinsicsACalibrationAnewIsProposed) {
  const Verdict other = VerdictOfLenses({TriedOn("right", true, CameraModel::kPinholeRational)});
  EXPECT_THAT(other.why, HasSubstr("in a way that pinhole_radtan cannot"));
  EXPECT_EQ(
      other.what_to_do,
      "Leave the intrinsics of right out of session.yaml and set `model: pinhole_rational` "
      "(pinhole_rational fits pictures of right that were left out to 0.21 px, the given intrinsics to 0.43 px).");
  const Verdict numbers = VerdictOfLenses({TriedOn("right", true, CameraModel::kPinholeRadtan)});
  EXPECT_THAT(numbers.why, HasSubstr("in a way that the given pinhole_radtan cannot"));
  EXPECT_THAT(numbers.what_to_do,
              HasSubstr("set `model: pinhole_radtan` (pinhole_radtan fits pictures of right that were left "
                        "out to 0.25 px, the given intrinsics to 0.43 px)"));
}

TEST(AssessLens, WhereNoModelIsBetterThatIsSaidWithWhatHelps) {
  EXPECT_EQ(
      VerdictOfLenses({TriedOn("right", false, std::nullopt)}).what_to_do,
      "Capture boards all over the pictures of right, as the bend is taken out where corners were seen (none "
      "of pinhole_radtan, pinhole_rational and fisheye_kb4 fits the pictures of right that were left out better).");
  EXPECT_THAT(VerdictOfLenses({TriedOn("right", true, std::nullopt)}).what_to_do,
              HasSubstr("all over the pictures of right, and leave out or give a sigma with their intrinsics"));
  EXPECT_EQ(
      VerdictOfLenses({TriedOn("right", false, std::nullopt), TriedOn("top", false, CameraModel::kPinholeRational)})
          .what_to_do,
      "Set `model: pinhole_rational` for top (pinhole_rational fits pictures of top that were left out to 0.21 px, "
      "pinhole_radtan to 0.43 px); capture boards all over the pictures of right, as the bend is taken out where "
      "corners were seen (none of pinhole_radtan, pinhole_rational and fisheye_kb4 fits the pictures of right that "
      "were left out better).");
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
  EXPECT_THAT(verdict.why, HasSubstr("Pairs of sensors disagree because the lens of right bends"));
}

TEST(AssessRefined, WhatIsGrosslyOffFailsAllTheSame) {
  Rig rig = Contradicted(0.06);
  rig.solution.fused.sessions = {SessionId(std::string(64, '1'))};
  EXPECT_EQ(Assess(rig.edges, rig.solution).level, VerdictLevel::kFail);
}

TEST(AssessRefined, APairThatTheRefinementLeftOutStandsForItself) {
  Rig rig = Contradicted(0.02);
  rig.solution.fused.sessions = {SessionId(std::string(64, '1'))};
  SessionEstimate estimate = BentSession('1', {});
  estimate.contradicted = {{rig.edges[0].frame_b, rig.edges[0].frame_a, Vector6d::Unit(0) * 0.02, 1e-9}};
  EXPECT_EQ(Assess(rig.edges, rig.solution, {}, {}, {estimate}).level, VerdictLevel::kFail);
  estimate.contradicted[0].a = SensorId("another");
  EXPECT_EQ(Assess(rig.edges, rig.solution, {}, {}, {estimate}).level, VerdictLevel::kPass);
}

TEST(AssessRefined, ALidarThatLostSightIsNotVerifiedUntilItSeesAgain) {
  const Rig rig;
  SessionEstimate lost = BentSession('1', {});
  lost.lost_sights = {{SensorId("top"), CaptureId("017"), CaptureId("018"), 18, 6, 1e-6}};
  const Verdict verdict = Assess(rig.edges, rig.solution, {}, {}, {lost});
  EXPECT_EQ(verdict.level, VerdictLevel::kUnknown);
  EXPECT_EQ(verdict.unverified, "top");
  EXPECT_THAT(verdict.why, HasSubstr("op saw no board where the others saw one in 6 captures"));
  EXPECT_THAT(verdict.why, HasSubstr("all from 018 on: it was moved by more than 300 mm or 11 deg, or something hid"));
  EXPECT_THAT(verdict.what_to_do, HasSubstr("`rigcal push FOLDER --remounted top`"));
  EXPECT_EQ(Assess(rig.edges, rig.solution, {}, {}, {BentSession('2', {}), lost}).level, VerdictLevel::kPass);
}

SessionEstimate ContradictedAtTheEnd(const char* sensor, const char* against) {
  SessionEstimate estimate = BentSession('1', {});
  estimate.reference = SensorId("left");
  for (const char* name : {"left", "right", "top"}) estimate.poses.push_back({SensorId(name), {}, 0.0});
  estimate.late = {{SensorId(sensor), CaptureId("039"), 2, against[0] == 0 ? SensorId() : SensorId(against)}};
  return estimate;
}

TEST(AssessRefined, ASensorWhoseLastCapturesContradictTheRestIsNotVerified) {
  const Rig rig;
  SessionEstimate late = ContradictedAtTheEnd("right", "");
  const Verdict verdict = Assess(rig.edges, rig.solution, {}, {}, {late});
  EXPECT_EQ(verdict.level, VerdictLevel::kUnknown);
  EXPECT_EQ(verdict.unverified, "right");
  EXPECT_THAT(verdict.why, HasSubstr("hat right saw from capture 039 on, its last, of the session of"));
  EXPECT_THAT(verdict.why, HasSubstr("contradicts the rest: right was moved before it, or what was captured is of "
                                     "another instant"));
  EXPECT_EQ(verdict.what_to_do,
            "Check the mount of right, capture again, then `rigcal push FOLDER`; if it was moved, `rigcal push FOLDER "
            "--remounted right`.");
  late.late[0].captures = 1;
  late.late[0].or_board = TargetId("wall");
  EXPECT_THAT(Assess(rig.edges, rig.solution, {}, {}, {late}).why,
              HasSubstr("right was moved before it, or board wall was, or what was captured is of another instant"));
  EXPECT_THAT(Assess(rig.edges, rig.solution, {}, {}, {late}).why,
              HasSubstr("hat right saw in its last capture, 039, of the session of"));
  late.late.clear();
  EXPECT_EQ(Assess(rig.edges, rig.solution, {}, {}, {late}).level, VerdictLevel::kPass);
}

TEST(AssessRefined, LastCapturesOfTheReferenceLeaveNoPoseVerified) {
  const Rig rig;
  EXPECT_EQ(Assess(rig.edges, rig.solution, {}, {}, {ContradictedAtTheEnd("left", "")}).unverified, "right and top");
}

TEST(AssessRefined, OfTwoThatContradictEachOtherInTheLastCapturesEitherMayHaveMoved) {
  const Rig rig;
  const Verdict verdict = Assess(rig.edges, rig.solution, {}, {}, {ContradictedAtTheEnd("right", "top")});
  EXPECT_EQ(verdict.unverified, "right and top");
  EXPECT_THAT(verdict.why, HasSubstr("right or top was moved before it"));
  EXPECT_THAT(verdict.what_to_do, HasSubstr("Check the mount of right and top, capture again"));
}

TEST(AssessRefined, WhereNothingTellsWhichOfTwoMovedBothAreNamed) {
  const Rig rig;
  SessionEstimate bumped = BentSession('1', {});
  SensorMovedWithin moved{SensorId("right"), CaptureId("019"), CaptureId("020"), Vector6d::Unit(0) * 0.02, 1e-9};
  moved.or_sensor = SensorId("left");
  bumped.moved = {moved};
  const Verdict verdict = Assess(rig.edges, rig.solution, {}, {}, {bumped});
  EXPECT_EQ(verdict.level, VerdictLevel::kFail);
  EXPECT_THAT(verdict.why, HasSubstr("ight or left was moved during the session of"));
  EXPECT_THAT(verdict.what_to_do, HasSubstr("ighten the mount of right and left, capture again, then `rigcal push "
                                            "FOLDER --remounted right,left`"));
  bumped.moved[0].or_sensor = SensorId();
  bumped.moved[0].or_board = TargetId("wall");
  EXPECT_THAT(Assess(rig.edges, rig.solution, {}, {}, {bumped}).why,
              HasSubstr(", by 20 mm and 0 deg, or board wall was"));
}

TEST(AssessRefined, PairsBeforeABoardThatMovedAccuseNoSensor) {
  Rig rig = Contradicted(0.06);
  rig.solution.fused.sessions = {SessionId(std::string(64, '1'))};
  SessionEstimate moved = BentSession('1', {});
  rig.edges[0].method = NameOf(Method::kStereo);  // takes no board to stand still
  moved.boards_moved.push_back({TargetId("wall"), CaptureId("019"), CaptureId("020"), Vector6d::Unit(0) * 0.005, 1e-9});
  EXPECT_EQ(Assess(rig.edges, rig.solution, {}, {}, {moved}).level, VerdictLevel::kFail);
  rig.edges[0].method = NameOf(Method::kTrackerCamera);
  const Verdict verdict = Assess(rig.edges, rig.solution, {}, {}, {moved});
  EXPECT_EQ(verdict.level, VerdictLevel::kWarn);
  EXPECT_THAT(verdict.why, HasSubstr("oard wall was moved"));
  moved.session = SessionId(std::string(64, '2'));
  EXPECT_EQ(Assess(rig.edges, rig.solution, {}, {}, {moved}).level, VerdictLevel::kFail);
}

std::string RemarkOnBend(bool is_the_board, std::vector<SensorId> seen_by) {
  const Rig rig;
  SessionEstimate estimate = BentSession('1', {});
  estimate.bends = {{TargetId("wall"), 5.2e-4, 1e-5, is_the_board, std::move(seen_by)}};
  return Assess(rig.edges, rig.solution, {}, {}, {estimate}).why;
}

TEST(AssessRefined, ABentBoardIsAFactOnlyWhereItCannotBeALens) {
  const SensorId left("left"), right("right");
  EXPECT_THAT(RemarkOnBend(true, {left, right}),
              HasSubstr("oard wall is bent by 0.52 mm, which was taken out: a stiffer plate is better"));
  EXPECT_THAT(
      RemarkOnBend(false, {left, right}),
      HasSubstr("oard wall is bent by 0.52 mm, or the lenses of left and right make it look so; it was taken out: "
                "lay a straight edge across the board"));
  EXPECT_THAT(RemarkOnBend(false, {right}), HasSubstr("or the lens of right makes it look so"));
  EXPECT_THAT(RemarkOnBend(false, {}), HasSubstr("or a lens makes it look so")) << "as estimates of before have it";
}

TEST(AssessRefined, PrintsOfOnePrinterAreToldTogether) {
  const Rig rig;
  SessionEstimate estimate = BentSession('1', {});
  const std::vector<SensorId> by_left = {SensorId("left")};
  estimate.stretches = {{TargetId("wall"), 1e-3, 1e-5, 10, 7, by_left}, {TargetId("weak"), 1e-4, 1e-5, 10, 7, by_left}};
  EXPECT_THAT(
      Assess(rig.edges, rig.solution, {}, {}, {estimate}).why,
      HasSubstr("rint of board wall is longer by 0.1 % along the side of 10 corners than along that of 7, or the "
                "lens of left makes it look so; it was taken out: measure ten squares each way"));
  estimate.stretches[1].longer_ratio = 1e-3;
  EXPECT_THAT(Assess(rig.edges, rig.solution, {}, {}, {estimate}).why,
              HasSubstr("or the lens of left makes it look so"))
      << "one lens before two boards";
  estimate.stretches[1].seen_by = {SensorId("right")};
  EXPECT_THAT(Assess(rig.edges, rig.solution, {}, {}, {estimate}).why,
              HasSubstr("or the lenses of left and right make it"))
      << "two lenses before a board each";
  estimate.stretches[1].longer_ratio = 1.03e-3;  // alike within what each is known by
  estimate.stretches[1].seen_by = {SensorId("right"), SensorId("top")};
  EXPECT_THAT(
      Assess(rig.edges, rig.solution, {}, {}, {estimate}).why,
      HasSubstr("rints of boards wall and weak are longer by 0.1 % along the side of 10 corners than along that "
                "of 7, which was taken out"));
}

TEST(AssessRefined, AnEdgeOfAnotherSourceAccusesAllTheSame) {
  Rig rig = Contradicted(0.02);
  rig.solution.fused.sessions = {SessionId(std::string(64, '1'))};
  rig.edges[0].session = SessionId();
  EXPECT_EQ(Assess(rig.edges, rig.solution).level, VerdictLevel::kFail);
}

TEST(AssessRefined, ASensorThatMovedBetweenSessionsFails) {
  Rig rig;
  SensorMovedBetween moved{
      SensorId("right"), SessionId(std::string(64, '1')), SessionId(std::string(64, '2')), {}, 1e-9};
  moved.step[0] = 0.0097;
  rig.solution.fused.moved = {moved};
  const SessionTimes times = {{moved.last_before, Stamp{0}}, {moved.first_after, Stamp{86'400'000'000'000}}};
  const Verdict verdict = Assess(rig.edges, rig.solution, {}, times);
  EXPECT_EQ(verdict.level, VerdictLevel::kFail);
  EXPECT_THAT(verdict.why, HasSubstr("right was moved between the sessions of 1970-01-01 and 1970-01-02, by 9.7 mm"));
  EXPECT_EQ(
      verdict.what_to_do,
      "Was right moved after 1970-01-01? Yes: `rigcal push FOLDER --remounted right` of the session of 1970-01-02. "
      "No: tighten the mount, capture again, then `rigcal push FOLDER --remounted right`.");
}

}  // namespace
}  // namespace rigcal::fleet
