#include "server/formats/revision/session_estimate.h"

#include <gtest/gtest.h>

namespace rigcal::formats {
namespace {

SessionEstimate MakeEstimate() {
  SessionEstimate estimate;
  estimate.session = SessionId(std::string(64, 'a'));
  estimate.reference = SensorId("left");
  RefinedPose pose;
  pose.sensor = SensorId("right");
  pose.T_ref_sensor = Se3::Exp((Vector6d() << 0.1, 0.2, 0.3, 0.01, 0.02, 0.03).finished());
  pose.dof = 25.5;
  pose.smallest_move = {0.002, 0.003, 19};
  estimate.poses = {{SensorId("left"), {}, 0.0}, pose};
  estimate.covariance = 1e-8 * Matrix6d::Identity();
  estimate.covariance(tangent::kX, tangent::kRz) = estimate.covariance(tangent::kRz, tangent::kX) = 2e-9;
  estimate.common = 0.25 * estimate.covariance;
  SensorMovedWithin moved;
  moved.sensor = SensorId("right");
  moved.last_before = CaptureId("019"), moved.first_after = CaptureId("020");
  moved.step[tangent::kY] = 0.02;
  moved.odds = 1e-30;
  SensorMovedWithin refocused = moved;
  refocused.lens = {0.003, 1e-5, true};
  refocused.or_sensor = SensorId("left");
  refocused.or_board = TargetId("wall");
  refocused.or_world_of = SensorId("mast");
  estimate.moved = {moved, refocused};
  estimate.boards_moved = {{TargetId("wall"), CaptureId("011"), CaptureId("012"), moved.step, 1e-9, TargetId("door")},
                           {{}, CaptureId("007"), CaptureId("008"), moved.step, 1e-9, {}, SensorId("mast")}};
  estimate.held_back = {{SensorId("left"), CaptureId("007"), SensorId("right")}, {SensorId("left"), CaptureId("008")}};
  estimate.held_back[1].why = WhyHeldBack::kPlaceUnknown;
  estimate.late = {{SensorId("left"), CaptureId("018"), 2, SensorId("right"), TargetId("wall")},
                   {SensorId("top"), CaptureId("019"), 1}};
  estimate.late[1].or_world = true;
  LensMisfit misfit;
  misfit.camera = SensorId("right");
  misfit.model = CameraModel::kPinholeRational;
  misfit.rms_px = 0.05, misfit.evidence = 300, misfit.sigma_ratio = 2.5;
  misfit.pose_sigma_m = 1e-4, misfit.pose_sigma_rad = 2e-4;
  misfit.trial = {0.43,
                  true,
                  24,
                  {{CameraModel::kPinholeRadtan, std::nullopt, true}, {CameraModel::kPinholeRational, 0.21}},
                  CameraModel::kPinholeRational};
  estimate.misfits = {misfit};
  CameraIntrinsics lens;
  lens.fx_px = 500.25, lens.fy_px = 501.5, lens.cx_px = 320.125, lens.cy_px = 240;
  lens.distortion = {0.1, -0.05, 1e-3, 0, 0};
  estimate.lenses = {{SensorId("right"), lens, 0.01 * Eigen::MatrixXd::Identity(9, 9)}};
  estimate.slants = {{SensorId("top"), 0.01, 0.002}};
  estimate.pupil_shifts = {{SensorId("right"), 0.0005, 0.00003}};
  estimate.stretches = {{TargetId("board"), 0.001, 0.00002, 10, 7, {SensorId("left")}}};
  estimate.look_scatter = {{SensorId("left"), 7.5e-5}};
  estimate.by_pairs = {{SensorId("left"), {0.004, 0.002, 40}}};
  estimate.groups = {{{CaptureId("001"), CaptureId("002")}, SensorId("right"), 1.25}, {{CaptureId("003")}}};
  estimate.noise = {{SensorId("left"), 0.031}, {SensorId("body"), 0.0, 0.0, 2e-4, 9e-4}};
  estimate.contradicted_lenses = {{SensorId("left"), 11.5, 0.0079, SensorId("right")}};
  estimate.bends = {{TargetId("board"), 0.0005, 0.00001, true, {SensorId("left"), SensorId("right")}}};
  estimate.clocks = {{SensorId("body"), 0.0123, 0.0004, 0.05, 30}};
  estimate.lost_sights = {{SensorId("top"), CaptureId("017"), CaptureId("018"), 18, 6, 1e-6}};
  estimate.contradicted = {{SensorId("front"), SensorId("top"), moved.step, 1e-12}};
  return estimate;
}

TEST(SessionEstimateDocument, HasIslandsAsEstimatesOfTheirOwn) {
  SessionEstimate whole = MakeEstimate();
  EXPECT_EQ(WriteSessionEstimate(whole).find("islands"), std::string::npos);
  SessionEstimate island = MakeEstimate();
  island.why_not = {{kRefinementFailed, "no minimum", "Take more captures."}};
  whole.islands = {island, MakeEstimate()};
  const auto read = ReadSessionEstimate(WriteSessionEstimate(whole));
  ASSERT_TRUE(read) << Sentence(read.error());
  ASSERT_EQ(read->islands.size(), 2u);
  EXPECT_EQ(read->islands[0].why_not.front().code, kRefinementFailed);
  EXPECT_EQ(read->islands[1].poses[1].sensor, SensorId("right"));
  EXPECT_EQ(read->islands[1].covariance, island.covariance);
  EXPECT_TRUE(read->islands[1].islands.empty());
}

TEST(SessionEstimateDocument, TellsWhatIsWrongWithCameras) {
  const auto read = ReadSessionEstimate(WriteSessionEstimate(MakeEstimate()));
  ASSERT_TRUE(read) << Sentence(read.error());
  ASSERT_EQ(read->look_scatter.size(), 1u);
  EXPECT_EQ(read->look_scatter[0].camera, SensorId("left"));
  EXPECT_EQ(read->look_scatter[0].sigma_rad, 7.5e-5);
  ASSERT_EQ(read->by_pairs.size(), 1u);
  EXPECT_EQ(read->by_pairs[0].sensor, SensorId("left"));
  EXPECT_EQ(read->by_pairs[0].move.m, 0.004);
  EXPECT_EQ(read->by_pairs[0].move.captures, 40);
  ASSERT_EQ(read->contradicted_lenses.size(), 1u);
  EXPECT_EQ(read->contradicted_lenses[0].camera, SensorId("left"));
  EXPECT_EQ(read->contradicted_lenses[0].shift_px, 11.5);
  EXPECT_EQ(read->contradicted_lenses[0].shift_rad, 0.0079);
  EXPECT_EQ(read->contradicted_lenses[0].like, SensorId("right"));
}

TEST(SessionEstimateDocument, TellsWhichCapturesCountAsOneAndHowNoisySensorsAre) {
  const auto read = ReadSessionEstimate(WriteSessionEstimate(MakeEstimate()));
  ASSERT_TRUE(read) << Sentence(read.error());
  ASSERT_EQ(read->groups.size(), 2u);
  EXPECT_EQ(read->groups[0].captures, (std::vector{CaptureId("001"), CaptureId("002")}));
  EXPECT_EQ(read->groups[0].sensor, SensorId("right"));
  EXPECT_EQ(read->groups[0].sigmas, 1.25);
  EXPECT_TRUE(read->groups[1].sensor.empty());
  ASSERT_EQ(read->noise.size(), 2u);
  EXPECT_EQ(read->noise[0].corner_px, 0.031);
  EXPECT_EQ(read->noise[1].sensor, SensorId("body"));
  EXPECT_EQ(read->noise[1].position_m, 2e-4);
  EXPECT_EQ(read->noise[1].rotation_rad, 9e-4);
}

TEST(SessionEstimateDocument, TellsAMoveFromAChangeOfTheLensAndWhoMayHaveMovedInstead) {
  const auto read = ReadSessionEstimate(WriteSessionEstimate(MakeEstimate()));
  ASSERT_TRUE(read) << Sentence(read.error());
  ASSERT_EQ(read->moved.size(), 2u);
  EXPECT_FALSE(read->moved[0].lens);
  EXPECT_EQ(read->moved[1].lens, (FocalChange{0.003, 1e-5, true}));
  EXPECT_TRUE(read->moved[0].or_sensor.empty());
  EXPECT_EQ(read->moved[1].or_sensor, SensorId("left"));
  EXPECT_EQ(read->moved[1].or_board, TargetId("wall"));
  EXPECT_EQ(read->moved[1].or_world_of, SensorId("mast"));
  EXPECT_EQ(read->boards_moved[0].or_board, TargetId("door"));
  EXPECT_EQ(read->boards_moved[1].world_of, SensorId("mast"));
  EXPECT_TRUE(read->boards_moved[1].board.empty());
}

TEST(SessionEstimateDocument, TellsWhoLostSightAndWhatWasContradicted) {
  const auto read = ReadSessionEstimate(WriteSessionEstimate(MakeEstimate()));
  ASSERT_TRUE(read) << Sentence(read.error());
  ASSERT_EQ(read->lost_sights.size(), 1u);
  EXPECT_EQ(read->lost_sights[0].first_lost, CaptureId("018"));
  EXPECT_EQ(read->lost_sights[0].seen, 18);
  EXPECT_EQ(read->lost_sights[0].lost, 6);
  ASSERT_EQ(read->contradicted.size(), 1u);
  EXPECT_EQ(read->contradicted[0].b, SensorId("top"));
  EXPECT_EQ(read->contradicted[0].off, MakeEstimate().contradicted[0].off);
  ASSERT_EQ(read->late.size(), 2u);
  EXPECT_EQ(read->late[0].first, CaptureId("018"));
  EXPECT_EQ(read->late[0].captures, 2);
  EXPECT_EQ(read->late[0].or_sensor, SensorId("right"));
  EXPECT_EQ(read->late[0].or_board, TargetId("wall"));
  EXPECT_TRUE(read->late[1].or_sensor.empty());
  EXPECT_FALSE(read->late[0].or_world);
  EXPECT_TRUE(read->late[1].or_world);
}

TEST(SessionEstimateDocument, ComesBackAsItWas) {
  const std::string text = WriteSessionEstimate(MakeEstimate());
  const auto read = ReadSessionEstimate(text);
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_EQ(WriteSessionEstimate(*read), text);
  ASSERT_EQ(read->poses.size(), 2u);
  EXPECT_EQ(read->covariance, MakeEstimate().covariance);
  EXPECT_EQ(read->common, MakeEstimate().common);
  EXPECT_EQ(RowOf(*read, 0), -1);
  EXPECT_EQ(RowOf(*read, 1), 0);
  EXPECT_EQ(read->poses[1].dof, 25.5);
  EXPECT_FALSE(read->poses[0].smallest_move);  // as in documents of before
  ASSERT_TRUE(read->poses[1].smallest_move);
  EXPECT_EQ(read->poses[1].smallest_move->m, 0.002);
  EXPECT_EQ(read->poses[1].smallest_move->rad, 0.003);
  EXPECT_EQ(read->poses[1].smallest_move->captures, 19);
  ASSERT_EQ(read->moved.size(), 2u);
  EXPECT_EQ(read->moved[0].step[tangent::kY], 0.02);
  EXPECT_EQ(read->moved[0].first_after, CaptureId("020"));
  EXPECT_EQ(read->held_back[0].capture, CaptureId("007"));
  EXPECT_EQ(read->held_back[0].against, SensorId("right"));
  EXPECT_TRUE(read->held_back[1].against.empty());
  EXPECT_EQ(read->held_back[0].why, WhyHeldBack::kContradicts);
  EXPECT_EQ(read->held_back[1].why, WhyHeldBack::kPlaceUnknown);
  ASSERT_EQ(read->boards_moved.size(), 2u);
  EXPECT_EQ(read->boards_moved[0].board, TargetId("wall"));
  EXPECT_EQ(read->boards_moved[0].first_after, CaptureId("012"));
  EXPECT_EQ(read->boards_moved[0].step[tangent::kY], 0.02);
  ASSERT_EQ(read->stretches.size(), 1u);
  EXPECT_EQ(read->stretches[0].longer_ratio, 0.001);
  EXPECT_EQ(read->stretches[0].sigma_ratio, 0.00002);
  EXPECT_EQ(read->stretches[0].corners_along, 10);
  EXPECT_EQ(read->stretches[0].corners_across, 7);
  EXPECT_THAT(read->stretches[0].seen_by, testing::ElementsAre(SensorId("left")));
  ASSERT_EQ(read->bends.size(), 1u);
  EXPECT_EQ(read->bends[0].board, TargetId("board"));
  EXPECT_EQ(read->bends[0].height_m, 0.0005);
  EXPECT_EQ(read->bends[0].sigma_m, 0.00001);
  EXPECT_TRUE(read->bends[0].is_the_board);
  ASSERT_EQ(read->bends[0].seen_by.size(), 2u);
  EXPECT_EQ(read->bends[0].seen_by[1], SensorId("right"));
  ASSERT_EQ(read->slants.size(), 1u);
  EXPECT_EQ(read->slants[0].lidar, SensorId("top"));
  EXPECT_EQ(read->slants[0].too_long_m, 0.01);
  EXPECT_EQ(read->slants[0].sigma_m, 0.002);
  ASSERT_EQ(read->pupil_shifts.size(), 1u);
  EXPECT_EQ(read->pupil_shifts[0].camera, SensorId("right"));
  EXPECT_EQ(read->pupil_shifts[0].shift_m, 0.0005);
  EXPECT_EQ(read->pupil_shifts[0].sigma_m, 0.00003);
  ASSERT_EQ(read->clocks.size(), 1u);
  EXPECT_EQ(read->clocks[0].tracker, SensorId("body"));
  EXPECT_EQ(read->clocks[0].late_s, 0.0123);
  EXPECT_EQ(read->clocks[0].sigma_s, 0.0004);
  EXPECT_EQ(read->clocks[0].given_sigma_s, 0.05);
  EXPECT_EQ(read->clocks[0].captures, 30);
  EXPECT_NE(text.find("\"known\":true"), std::string::npos);
}

TEST(SessionEstimateDocument, HasWhatALensDoesBeyondItsModel) {
  const auto read = ReadSessionEstimate(WriteSessionEstimate(MakeEstimate()));
  ASSERT_TRUE(read) << Sentence(read.error());
  ASSERT_EQ(read->misfits.size(), 1u);
  EXPECT_EQ(read->misfits[0].camera, SensorId("right"));
  EXPECT_EQ(read->misfits[0].model, CameraModel::kPinholeRational);
  EXPECT_EQ(read->misfits[0].sigma_ratio, 2.5);
  EXPECT_EQ(read->misfits[0].pose_sigma_rad, 2e-4);
  const LensTrial& trial = read->misfits[0].trial;
  EXPECT_EQ(trial.own_left_out_rms_px, 0.43);
  EXPECT_TRUE(trial.given);
  EXPECT_EQ(trial.captures, 24);
  EXPECT_EQ(trial.proposed, CameraModel::kPinholeRational);
  ASSERT_EQ(trial.candidates.size(), 2u);
  EXPECT_FALSE(trial.candidates[0].left_out_rms_px);
  EXPECT_TRUE(trial.candidates[0].absurd);
  EXPECT_EQ(trial.candidates[1].left_out_rms_px, 0.21);
  EXPECT_EQ(trial.candidates[1].model, CameraModel::kPinholeRational);
}

TEST(SessionEstimateDocument, HasTheLensesThatBelongToItsPoses) {
  const SessionEstimate made = MakeEstimate();
  const std::string text = WriteSessionEstimate(made);
  const auto read = ReadSessionEstimate(text);
  ASSERT_TRUE(read) << Sentence(read.error());
  ASSERT_EQ(read->lenses.size(), 1u);
  EXPECT_EQ(read->lenses[0].camera, SensorId("right"));
  EXPECT_EQ(read->lenses[0].intrinsics, made.lenses[0].intrinsics);
  EXPECT_EQ(read->lenses[0].covariance, made.lenses[0].covariance);
  SessionEstimate cut = made;
  cut.lenses[0].covariance = Eigen::MatrixXd::Identity(3, 3);
  EXPECT_FALSE(ReadSessionEstimate(WriteSessionEstimate(cut)));
}

TEST(SessionEstimateDocument, AMisfitForWhichNothingWasTriedHasNoTrial) {
  SessionEstimate estimate = MakeEstimate();
  estimate.misfits[0].trial = {};
  const std::string text = WriteSessionEstimate(estimate);
  EXPECT_EQ(text.find("trial"), std::string::npos) << "as documents of before have it";
  const auto read = ReadSessionEstimate(text);
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_TRUE(read->misfits[0].trial.candidates.empty());
  EXPECT_FALSE(read->misfits[0].trial.proposed);
}

TEST(SessionEstimateDocument, OneOfBeforeMisfitsWereLookedForHasNone) {
  std::string text = WriteSessionEstimate(MakeEstimate());
  const auto from = text.find("\"misfits\""), to = text.find("\"moved\"");
  ASSERT_LT(from, to);
  text.erase(from, to - from);
  const auto read = ReadSessionEstimate(text);
  ASSERT_TRUE(read) << Sentence(read.error());
  EXPECT_TRUE(read->misfits.empty());
}

TEST(SessionEstimateDocument, OneWithoutATrackersPathSaysNothingOfClocks) {
  SessionEstimate estimate = MakeEstimate();
  estimate.clocks.clear();
  const std::string text = WriteSessionEstimate(estimate);
  EXPECT_EQ(text.find("clocks"), std::string::npos);
  EXPECT_TRUE(ReadSessionEstimate(text)->clocks.empty());
}

TEST(SessionEstimateDocument, AClockOfABodyThatStoodStillIsNotKnown) {
  SessionEstimate estimate = MakeEstimate();
  estimate.clocks = {{SensorId("body"), 0.0, 0.05, 0.05, 0}};
  EXPECT_NE(WriteSessionEstimate(estimate).find("\"known\":false"), std::string::npos);
}

TEST(SessionEstimateDocument, RefusesALensThatIsNone) {
  std::string text = WriteSessionEstimate(MakeEstimate());
  text.replace(text.find("pinhole_rational"), 16, "pinhole_fanciful");
  const auto read = ReadSessionEstimate(text);
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().what.find("misfits[0].model"), std::string::npos) << read.error().what;
}

TEST(SessionEstimateDocument, RefusesWhatIsNone) {
  EXPECT_FALSE(ReadSessionEstimate("{}"));
  EXPECT_FALSE(ReadSessionEstimate("no document"));
  SessionEstimate estimate = MakeEstimate();
  estimate.covariance = Eigen::MatrixXd::Identity(12, 12);
  EXPECT_FALSE(ReadSessionEstimate(WriteSessionEstimate(estimate)));
}

}  // namespace
}  // namespace rigcal::formats
