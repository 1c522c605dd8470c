// What the files of a session show, and what they do not.
#include <gmock/gmock.h>

#include "tests/unit/fleet_visit.h"

namespace rigcal::fleet {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;
using testing::StartsWith;

TEST(MissingFiles, AreToldByTheirNumber) {
  Visit visit(StereoBoard());
  const Letters all(15, 'B'), some = "BB....         ";
  for (const char* other : {"front", "left", "right"}) visit.AddStereo("left_front", some, other, all);
  const RootCause cause = OneCause(visit, CauseKind::kFilesMissing);
  EXPECT_THAT(cause.edges, SizeIs(3));
  EXPECT_THAT(cause.sensors, ElementsAre(SensorId("left_front")));
  EXPECT_EQ(cause.said.why, "left_front has files for 6 of 15 captures");
  EXPECT_EQ(cause.said.what_to_do, "Copy what is missing into left_front/, or take these captures again");
}

TEST(MissingFiles, OfALidarExplainItsPairsWithOthersToo) {
  Visit visit(LidarBoard());
  visit.AddLidarCamera("front", "BBBBBBBB", "top", "        ");
  visit.AddSensor("low", SensorKind::kLidar);
  visit.AddFailed("low", "top", "lidar_lidar", "no_common_clouds", {{"captures_total", 8}});
  const RootCause cause = OneCause(visit, CauseKind::kFilesMissing);
  EXPECT_THAT(cause.edges, SizeIs(2));
  EXPECT_EQ(cause.said.why, "top has no files");
}

TEST(MissingFiles, OfSensorsThatWereRecordedInTurnAreNotMissing) {
  Visit visit(StereoBoard());
  visit.AddStereo("front", "BBBBBBB         ", "left", "       BBBBBBBBB");
  ASSERT_EQ(visit.edges.front().figures.at("captures_total"), 16);
  EXPECT_THAT(visit.Causes(), SizeIs(0));
}

TEST(MissingFiles, OfATrackerAreItsPoses) {
  Visit visit(StereoBoard());
  visit.AddSensor("body", SensorKind::kTracker);
  visit.AddSensor("front", SensorKind::kCamera);
  visit.AddFailed(
      "front", "body", "tracker_camera", "too_few_captures",
      {{"captures_total", 40}, {"files_a", 40}, {"files_with_board_a", 31}, {"files_b", 3}, {"files_with_board_b", 3}});
  const RootCause cause = OneCause(visit, CauseKind::kFilesMissing);
  EXPECT_EQ(cause.said.why, "body has poses for 3 of 40 captures");
  EXPECT_THAT(cause.said.what_to_do, HasSubstr("into body/poses.csv"));
}

TEST(UnreadableFiles, AreCountedAndTheFirstIsNamed) {
  Visit visit(StereoBoard());
  visit.AddStereo("front", "B.xx.x", "left", "BBBBBB");
  visit.AddStereo("rear", "BBBBBB", "front", "B.xx.x");
  const RootCause cause = OneCause(visit, CauseKind::kFilesUnreadable);
  EXPECT_THAT(cause.edges, SizeIs(2));
  EXPECT_THAT(cause.captures, ElementsAre(CaptureId("002")));
  EXPECT_EQ(cause.said.why, "3 of 6 pictures of front cannot be read, the first is 002");
  EXPECT_EQ(cause.said.what_to_do, "Copy them again from where they were recorded, or take these captures again");
}

TEST(UnreadableFiles, OfALidarAreClouds) {
  Visit visit(LidarBoard());
  visit.AddLidarCamera("front", "BBBBBBBB", "top", "xBB.xxxx");
  EXPECT_EQ(OneCause(visit, CauseKind::kFilesUnreadable).said.why,
            "5 of 8 clouds of top cannot be read, the first is 000");
}

TEST(UnseenBoard, IsToldOfTheSensorThatSeesItSeldom) {
  Visit visit(StereoBoard());
  visit.AddStereo("left", "BBBBBBBBBBBB", "rear", "............");
  visit.AddStereo("rear", "............", "right", "BBBBBBBBBBBB");
  const RootCause cause = OneCause(visit, CauseKind::kBoardUnseen);
  EXPECT_THAT(cause.edges, SizeIs(2));
  EXPECT_EQ(cause.said.why, "rear sees board calib in none of 12 pictures");
  EXPECT_EQ(cause.said.what_to_do, "Show the whole board to rear, sharp and evenly lit, in 8 more captures");
}

TEST(UnseenBoard, OfALidarMayBeAPlateOfAnotherSize) {
  Visit visit(LidarBoard());
  visit.AddLidarCamera("front", "BBBBBBBB", "top", "BB......");
  const RootCause cause = OneCause(visit, CauseKind::kBoardUnseen);
  EXPECT_EQ(cause.said.why, "top sees board wall in 2 of 8 clouds");
  EXPECT_THAT(cause.said.what_to_do, HasSubstr("and check its plate_size_m"));
}

TEST(UnseenBoard, CamerasThatLookDifferentWaysAreNotAccused) {
  Visit visit(StereoBoard());
  visit.AddStereo("left", "BBB.........", "rear", "...BBB......");
  EXPECT_THAT(visit.Causes(), SizeIs(0));
}

std::map<std::string, double> Seen(double of_a, double of_b, double captures) {
  return {{"captures_total", captures},
          {"files_a", captures},
          {"files_b", captures},
          {"files_with_board_a", of_a},
          {"files_with_board_b", of_b}};
}

TEST(UnseenBoard, CamerasThatSeeItInTurnAreNotAccused) {
  Visit visit(StereoBoard());
  for (const char* camera : {"front", "left"}) visit.AddSensor(camera, SensorKind::kCamera);
  visit.AddSensor("top", SensorKind::kLidar);
  visit.AddFailed("front", "left", "stereo", "too_few_captures", Seen(25, 24, 60));
  EXPECT_THAT(visit.Causes(), SizeIs(0));
  visit.AddGood("front", "top");
  visit.AddGood("left", "top");
  const Verdict verdict = visit.Judge(SolutionOf({"top", "front", "left"}, {}));
  EXPECT_THAT(verdict.why, StartsWith("The calibration of front - left failed"));
  EXPECT_THAT(verdict.what_to_do, StartsWith("Do what too_few_captures wants"));
}

TEST(UnseenBoard, ALidarAndACameraThatSeeItAtOtherTimesAreNotAccused) {
  Visit visit(LidarBoard());
  visit.AddLidarCamera("front", "BBBBB.........", "top", ".....BBBBBB...");
  ASSERT_EQ(visit.edges.front().diagnoses.front().code, "too_few_captures");
  EXPECT_THAT(visit.Causes(), SizeIs(0));
}

TEST(UnseenBoard, ASensorThatSeesItAlmostNeverIsAccusedUnlessAPairOfItSucceeded) {
  Visit visit(StereoBoard());
  for (const char* camera : {"front", "left"}) visit.AddSensor(camera, SensorKind::kCamera);
  visit.AddFailed("front", "left", "stereo", "too_few_captures", Seen(40, 6, 60));
  EXPECT_THAT(visit.Causes(), SizeIs(0)) << "a tenth of the pictures";
  visit.edges.back().figures["files_with_board_b"] = 5;
  EXPECT_EQ(OneCause(visit, CauseKind::kBoardUnseen).said.why, "left sees board calib in 5 of 60 pictures");
  visit.AddGood("left", "rear");
  EXPECT_THAT(visit.Causes(), SizeIs(0));
  visit.edges.back().session = SessionId(std::string(64, '2'));
  EXPECT_THAT(visit.Causes(), SizeIs(1)) << "that was another time";
}

TEST(ShortSession, IsToldWithItsCaptures) {
  Visit cameras(StereoBoard());
  cameras.AddStereos({{"left", "BB"}, {"rear", "BB"}, {"right", "BB"}});
  const RootCause cause = OneCause(cameras, CauseKind::kShortSession);
  EXPECT_THAT(cause.edges, SizeIs(3));
  EXPECT_EQ(cause.said.why, "the session of 2026-01-31 has 2 captures only");
  Visit lidar(LidarBoard());
  lidar.AddLidarCamera("front", "BBB", "top", "BBB");
  EXPECT_EQ(OneCause(lidar, CauseKind::kShortSession).said.why, "the session of 2026-01-31 has 3 captures only");
}

}  // namespace
}  // namespace rigcal::fleet
