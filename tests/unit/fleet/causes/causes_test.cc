// Failures with a cause in common are told once, by it.
#include <gmock/gmock.h>

#include "server/model/edges/past.h"
#include "tests/unit/fleet/causes/visit.h"

namespace rigcal::fleet {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;
using testing::StartsWith;

TEST(BoardCounts, TwentyOneFailuresOfABoardThatNobodyFindsAreOneLine) {
  Visit visit(StereoBoard());
  std::map<std::string, Letters> cameras;
  for (int k = 0; k < 7; ++k) cameras["camera_" + std::to_string(k)] = Letters(15, '.');
  visit.AddStereos(cameras);
  const RootCause cause = OneCause(visit, CauseKind::kBoardCounts);
  EXPECT_THAT(cause.edges, SizeIs(21));
  EXPECT_THAT(cause.sensors, SizeIs(7));
  EXPECT_THAT(cause.boards, ElementsAre(TargetId("calib")));
  EXPECT_EQ(cause.said.why,
            "board calib with 9 x 6 inner corners was not found in any of the 105 pictures of "
            "camera_0, camera_1, camera_2, camera_3, camera_4, camera_5 and 1 more");
  EXPECT_EQ(cause.said.what_to_do,
            "Open one of the pictures. It is dark, or without board calib: take caps off the lenses, light the board, "
            "capture again. The board is there: count its inner corners and correct `inner_corners` in session.yaml");
  EXPECT_EQ(cause.command, "rigcal push FOLDER");
  const Verdict verdict = visit.Judge({});
  EXPECT_EQ(verdict.level, VerdictLevel::kUnknown);
  EXPECT_EQ(verdict.why,
            "Board calib with 9 x 6 inner corners was not found in any of the 105 pictures of "
            "camera_0, camera_1, camera_2, camera_3, camera_4, camera_5 and 1 more.");
  EXPECT_EQ(verdict.what_to_do,
            "Open one of the pictures. It is dark, or without board calib: take caps off the lenses, light the board, "
            "capture again. The board is there: count its inner corners and correct `inner_corners` in session.yaml, "
            "then `rigcal push FOLDER`.");
}

TEST(BoardCounts, OfAMarkerBoardBeforeOneCameraTheDictionaryCountsToo) {
  Target board = LidarBoard();
  board.kind = TargetKind::kAprilGrid;
  board.dictionary = "DICT_APRILTAG_36h11";
  Visit visit(board);
  visit.AddLidarCamera("front", "........", "top", "BBBBBBBB");
  visit.AddLidarCamera("front", "........", "low", "BBBBB..B");
  const RootCause cause = OneCause(visit, CauseKind::kBoardCounts);
  EXPECT_THAT(cause.edges, SizeIs(2));
  EXPECT_EQ(cause.said.why, "front found board wall with 7 x 5 tags in none of 8 pictures");
  EXPECT_THAT(cause.said.what_to_do,
              HasSubstr("The board is there: count its tags, check its dictionary and correct both in session.yaml"));
}

TEST(BoardCounts, ABoardThatAnybodyFindsIsCountedRight) {
  Visit visit(StereoBoard());
  visit.AddStereos({{"left", "BB.........."}, {"rear", "............"}, {"right", "............"}});
  EXPECT_EQ(CauseOfKind(visit.Causes(), CauseKind::kBoardCounts), nullptr);
  Visit measured(StereoBoard());
  measured.AddStereos({{"left", "............"}, {"rear", "............"}});
  measured.AddSensor("top", SensorKind::kLidar);
  measured.AddGood("left", "top");
  measured.edges.back().method = "lidar_camera";
  EXPECT_EQ(CauseOfKind(measured.Causes(), CauseKind::kBoardCounts), nullptr);
}

TEST(BoardSize, PairsThatAgreeOnAnotherSizeAreOneLine) {
  Target board = StereoBoard();
  board.square_m = 0.09;
  Visit visit(board);
  visit.AddSensor("top", SensorKind::kLidar);
  for (const char* camera : {"front", "left", "rear"}) {
    visit.AddSensor(camera, SensorKind::kCamera);
    visit.AddFailed(camera, "top", "lidar_camera", "board_size_suspected",
                    {{"board_scale_ratio", 0.03}, {"board_scale_sigma_ratio", 0.002}, {"board_square_m", 0.09}});
  }
  visit.AddSensor("right", SensorKind::kCamera);
  visit.AddFailed("right", "top", "lidar_camera", "high_residual");  // of the same board
  const RootCause cause = OneCause(visit, CauseKind::kBoardSize);
  EXPECT_THAT(cause.edges, SizeIs(4));
  EXPECT_THAT(cause.boards, ElementsAre(TargetId("calib")));
  EXPECT_EQ(cause.said.why,
            "the squares of board calib are probably 92.70 mm, not 90.00 mm (3 pairs see it 3 % larger)");
  EXPECT_EQ(cause.said.what_to_do,
            "Measure one with a caliper and correct session.yaml, probably to `square_size_m: 0.0927`");
}

TEST(BoardSize, OfTheEstimatorsOwnPairs) {
  Target board = LidarBoard();
  board.square_m = 0.105;  // it is 0.1
  Visit visit(board);
  visit.AddSensor("front", SensorKind::kCamera);
  visit.AddSensor("top", SensorKind::kLidar);
  visit.AddSensor("low", SensorKind::kLidar);
  for (const char* lidar : {"top", "low"}) visit.Add(MissizedLidarCamera("front", lidar, board.square_m));
  const RootCause cause = OneCause(visit, CauseKind::kBoardSize);
  EXPECT_THAT(cause.edges, SizeIs(2));
  EXPECT_THAT(cause.said.why, testing::MatchesRegex("the squares of board wall are probably (99|100)\\.[0-9]+ mm, not "
                                                    "105\\.00 mm \\(2 pairs see it [45]\\.?[0-9]* % smaller\\)"));
}

TEST(BoardSize, PairsThatDisagreeAccuseNoBoard) {
  Visit visit(StereoBoard());
  visit.AddSensor("top", SensorKind::kLidar);
  for (const auto& [camera, ratio] : {std::pair{"front", 0.03}, {"left", -0.025}}) {
    visit.AddSensor(camera, SensorKind::kCamera);
    visit.AddFailed(camera, "top", "lidar_camera", "board_size_suspected",
                    {{"board_scale_ratio", ratio}, {"board_scale_sigma_ratio", 0.002}, {"board_square_m", 0.03}});
  }
  EXPECT_THAT(visit.Causes(), SizeIs(0));
  EXPECT_EQ(visit.Judge(SolutionOf({"top", "front", "left"}, {})).level, VerdictLevel::kUnknown);
}

TEST(LensModel, IsOneLinePerCameraHoweverManyPairsItFails) {
  Visit visit(StereoBoard());
  for (const char* camera : {"front", "left", "rear", "right"}) visit.AddSensor(camera, SensorKind::kCamera);
  visit.AddFailed("front", "left", "stereo", "high_residual", {{"rms_as_fisheye_kb4_a_px", 0.31}});
  visit.AddFailed("rear", "front", "stereo", "ill_conditioned", {{"rms_as_fisheye_kb4_b_px", 0.21}});
  visit.AddFailed("front", "right", "stereo", "high_residual", {{"rms_as_fisheye_kb4_a_px", 0.29}});
  const RootCause cause = OneCause(visit, CauseKind::kLensModel);
  EXPECT_THAT(cause.edges, SizeIs(3));
  EXPECT_EQ(cause.said.why, "the lens of front is not pinhole_radtan: as fisheye_kb4 it fits to 0.21 px");
  EXPECT_EQ(cause.said.what_to_do, "Give front `model: fisheye_kb4` in session.yaml");
}

TEST(LensModel, OfBothCamerasOfAPairIsTwoLines) {
  Visit visit(StereoBoard());
  for (const char* camera : {"left", "right"}) visit.AddSensor(camera, SensorKind::kCamera);
  visit.header.sensors[1].camera_model = CameraModel::kFisheyeKb4;
  visit.AddFailed("left", "right", "stereo", "high_residual",
                  {{"rms_as_pinhole_rational_a_px", 0.28}, {"rms_as_pinhole_rational_b_px", 0.3}});
  const std::vector<RootCause> causes = visit.Causes();
  ASSERT_THAT(causes, SizeIs(2));
  EXPECT_EQ(causes[0].said.why, "the lens of left is not pinhole_radtan: as pinhole_rational it fits to 0.28 px");
  EXPECT_EQ(causes[1].said.why, "the lens of right is not fisheye_kb4: as pinhole_rational it fits to 0.3 px");
}

TEST(BoardTilt, OfCamerasSaysByHowMuch) {
  Visit visit(StereoBoard());
  for (const char* camera : {"front_left", "front_right"}) visit.AddSensor(camera, SensorKind::kCamera);
  visit.Add(FlatStereo("front_left", "front_right"));
  const RootCause cause = OneCause(visit, CauseKind::kBoardTilt);
  EXPECT_THAT(cause.sensors, Contains(SensorId("front_left")));
  EXPECT_THAT(cause.said.why, testing::MatchesRegex("the board was not tilted enough for .*: by [0-9.]+ deg at most"));
  EXPECT_EQ(cause.command, "rigcal check FOLDER");
}

TEST(BoardTilt, OfALidarAndACameraNamesBoth) {
  Visit visit(LidarBoard());
  visit.AddSensor("front_left", SensorKind::kCamera);
  visit.AddSensor("top", SensorKind::kLidar);
  visit.Add(FlatLidarCamera("front_left", "top"));
  const RootCause cause = OneCause(visit, CauseKind::kBoardTilt);
  EXPECT_EQ(cause.said.why, "the board was not tilted enough for front_left and top");
  EXPECT_EQ(cause.said.what_to_do, "Tilt the board 30 degrees left, right, up and down: 8 more captures");
}

TEST(BoardPlaces, AreToldOfCameras) {
  Visit visit(StereoBoard());
  for (const char* camera : {"left", "rear", "right"}) visit.AddSensor(camera, SensorKind::kCamera);
  visit.AddFailed("left", "right", "stereo", "distortion_not_observable");
  EXPECT_EQ(OneCause(visit, CauseKind::kBoardPlaces).said.why,
            "the board was seen in too few places by left and right");
  visit.AddFailed("left", "rear", "stereo", "ill_conditioned");
  const RootCause cause = OneCause(visit, CauseKind::kBoardPlaces);
  EXPECT_THAT(cause.edges, SizeIs(2));
  EXPECT_THAT(cause.said.why, HasSubstr("by left, rear and right"));
  EXPECT_EQ(cause.said.what_to_do, "Hold the board in all corners of the picture, near and far: 8 more captures");
}

// Of captures of which each sensor has a file. The first sees the board in `of_a` of them, the second in `of_b`.
TEST(NotMeasured, SensorsOfTheListThatNoEdgeNames) {
  Visit visit(StereoBoard());
  visit.AddGood("left", "right");
  const Verdict one = visit.Judge(SolutionOf({"left", "right"}, {"left_rear"}));
  EXPECT_EQ(one.level, VerdictLevel::kUnknown);
  EXPECT_EQ(one.why, "No session measured left_rear.");
  EXPECT_EQ(one.what_to_do, "Capture left_rear together with a known sensor, or take it out of session.yaml.");
  const Verdict two = visit.Judge(SolutionOf({"left", "right"}, {"left_rear", "top"}));
  EXPECT_EQ(two.why, "No session measured left_rear and top.");
  EXPECT_THAT(two.what_to_do, HasSubstr("or take them out"));
}

// The pairs of the camera without files would fail for the counts, too; but its files are missing all the same.
TEST(Mixed, TwoCausesAtOnceAreTwoLinesTheWorstFirst) {
  Visit visit(StereoBoard());
  const Letters none(12, '.');
  visit.AddStereos({{"front", none}, {"left", none}, {"rear", "..          "}, {"right", none}, {"top", none}});
  const std::vector<RootCause> causes = visit.Causes();
  ASSERT_THAT(causes, SizeIs(2));
  EXPECT_EQ(causes[0].kind, CauseKind::kBoardCounts);
  EXPECT_THAT(causes[0].edges, SizeIs(6));
  EXPECT_EQ(causes[1].kind, CauseKind::kFilesMissing);
  EXPECT_THAT(causes[1].edges, SizeIs(4));
  const Verdict verdict = visit.Judge({});
  EXPECT_EQ(verdict.why,
            "Board calib with 9 x 6 inner corners was not found in any of the 50 pictures of front, left, rear, right "
            "and top; "
            "also, rear has files for 2 of 12 captures.");
  EXPECT_THAT(verdict.what_to_do, HasSubstr("`rigcal push FOLDER`; then copy what is missing into rear/"));
}

TEST(Mixed, WhatNoCauseExplainsStaysAListOfPairs) {
  Visit visit(StereoBoard());
  visit.AddStereo("left", "BBBBBBBBBBBB", "rear", "............");
  visit.AddGood("left", "right");
  visit.AddGood("left", "top");
  visit.AddFailed("right", "top", "lidar_camera", "no_agreement");
  visit.AddFailed("front", "top", "lidar_camera", "no_agreement");
  visit.AddGood("front", "left");
  const Verdict verdict = visit.Judge(SolutionOf({"left", "right", "top", "front", "rear"}, {}));
  EXPECT_EQ(verdict.level, VerdictLevel::kWarn);
  EXPECT_THAT(verdict.why,
              StartsWith("rear sees board calib in none of 12 pictures; also, the calibration of right - top "
                         "and front - top failed; also, nothing checks"));
  EXPECT_THAT(verdict.what_to_do, HasSubstr("`rigcal check FOLDER`; then do what no_agreement wants; then "));
}

TEST(Mixed, SensorsThatACauseLeavesWithoutAPoseFollowFromIt) {
  Visit visit(StereoBoard());
  visit.AddStereo("left", "BBBBBBBBBBBB", "rear", "............");
  visit.AddGood("left", "right");
  visit.AddGood("rear", "mast");  // hangs on it, since another session
  visit.edges.back().session = SessionId(std::string(64, '2'));
  const Verdict lost = visit.Judge(SolutionOf({"left", "right"}, {"mast", "rear"}));
  EXPECT_EQ(lost.level, VerdictLevel::kUnknown);
  EXPECT_EQ(lost.why, "rear sees board calib in none of 12 pictures; so the poses of mast and rear are not known.");
  visit.AddFailed("right", "low", "lidar_camera", "no_agreement");
  const Verdict both = visit.Judge(SolutionOf({"left", "right"}, {"low", "mast", "rear"}));
  EXPECT_THAT(both.why,
              HasSubstr("mast and rear are not known; also, the pose of low is not known: no good edge ties it "
                        "to left (right - low failed: right and low failed)."));
}

// What has nothing to do with a sensor's pose is not said to be why it is not known.
TEST(Mixed, WhatIsNotKnownStandsBesideTheCauseThatItIsLostTo) {
  Visit visit(StereoBoard());
  visit.AddStereo("front", "            ", "right", "BBBBBBBBBBBB");
  visit.AddStereo("front", "            ", "rear", "BBBBBBBBBBBB");
  visit.AddFailed("left", "right", "stereo", "high_residual", {{"rms_as_fisheye_kb4_a_px", 0.2}});
  visit.AddSensor("left", SensorKind::kCamera);
  for (const char* camera : {"left", "right"}) visit.AddGood("rear", camera);
  const Verdict verdict = visit.Judge(SolutionOf({"rear", "right", "left"}, {"front"}));
  EXPECT_EQ(verdict.level, VerdictLevel::kUnknown);
  EXPECT_EQ(verdict.why,
            "front has no files; so the pose of front is not known; also, the lens of left is not pinhole_radtan: as "
            "fisheye_kb4 it fits to 0.2 px.");
}

// However the causes are sorted, a sensor is lost to the one that names it.
TEST(Mixed, EachCauseTellsWhatIsLostToIt) {
  Visit visit(StereoBoard());
  for (const char* camera : {"front", "left", "rear"}) visit.AddSensor(camera, SensorKind::kCamera);
  for (const char* other : {"front", "rear", "right"}) {
    visit.AddFailed("left", other, "stereo", "high_residual", {{"rms_as_fisheye_kb4_a_px", 0.2}});
    visit.AddSensor(other, SensorKind::kCamera);
  }
  visit.AddStereo("front", "            ", "right", "BBBBBBBBBBBB");
  visit.AddStereo("front", "            ", "rear", "BBBBBBBBBBBB");
  visit.AddGood("rear", "right");
  visit.AddGood("left", "low");
  EXPECT_EQ(
      visit.Judge(SolutionOf({"rear", "right"}, {"front", "left", "low"})).why,
      "The lens of left is not pinhole_radtan: as fisheye_kb4 it fits to 0.2 px; so the poses of left and low are "
      "not known; also, front has no files; so the pose of front is not known.");
}

TEST(OpenFailures, ArePairsThatNothingMeasuredSince) {
  Visit visit(StereoBoard());
  visit.AddStereo("left", "BBBBBBBBBBBB", "rear", "............");
  visit.AddGood("rear", "left");
  EXPECT_THAT(visit.Causes(), SizeIs(0));
  visit.edges.pop_back();
  visit.AddFailed("left", "rear", "stereo", std::string(kSupersededCode));
  EXPECT_THAT(visit.Causes(), SizeIs(1));
  visit.AddFailed("rear", "left", "stereo", "ambiguous_board");
  visit.edges.back().session = SessionId(std::string(64, '2'));
  SessionTimes times = visit.Times();
  times[visit.edges.back().session] = Stamp{visit.header.captured_at.ns + 1};
  EXPECT_THAT(FindRootCauses(visit.edges, {}, visit.Headers(), times), SizeIs(0))
      << "it failed otherwise the last time";
}

// As of pushed edges, or of sessions of before.
TEST(RootCauses, WithoutHeadersOrFiguresAreFewerAndNeverWrong) {
  Visit visit(StereoBoard());
  visit.AddStereos({{"left", "............"}, {"rear", "............"}});
  const std::vector<RootCause> causes = FindRootCauses(visit.edges, {}, {}, {});
  EXPECT_EQ(CauseOfKind(causes, CauseKind::kBoardCounts), nullptr) << "nobody says which board it is";
  const RootCause* unseen = CauseOfKind(causes, CauseKind::kBoardUnseen);
  ASSERT_NE(unseen, nullptr);
  EXPECT_EQ(unseen->said.why, "left sees a board in none of 12 pictures");
  visit.edges.front().figures.clear();
  EXPECT_THAT(FindRootCauses(visit.edges, {}, {}, {}), SizeIs(0));
}

}  // namespace
}  // namespace rigcal::fleet
