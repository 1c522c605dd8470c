// What the files of a session show, and what they do not.
#include <gmock/gmock.h>

#include "tests/unit/fleet/causes/visit.h"
#include "tests/unit/fleet/rig.h"

namespace rigcal::fleet {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
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

// A pair of two of them has no capture at all, which is no short session.
TEST(MissingFiles, OfSeveralSensorsAreOneCause) {
  Visit visit(StereoBoard());
  const Letters all(15, 'B'), none(15, ' ');
  for (const char* absent : {"back", "left_back"}) visit.AddStereo("front", all, absent, none);
  visit.AddFailed(
      "back", "left_back", "stereo", "too_few_captures",
      {{"captures_total", 0}, {"files_a", 0}, {"files_b", 0}, {"files_with_board_a", 0}, {"files_with_board_b", 0}});
  const RootCause cause = OneCause(visit, CauseKind::kFilesMissing);
  EXPECT_THAT(cause.edges, SizeIs(3));
  EXPECT_EQ(cause.said.why, "back and left_back have no files");
  EXPECT_EQ(FindingOf(cause).what_to_do,
            "Copy them into their folders, or take these captures again, then `rigcal push FOLDER`");
}

TEST(MissingFiles, OfSensorsThatWereRecordedInTurnAreNotMissing) {
  Visit visit(StereoBoard());
  visit.AddStereo("front", "BBBBBBB         ", "left", "       BBBBBBBBB");
  ASSERT_EQ(visit.edges.front().figures.at("captures_total"), 16);
  EXPECT_THAT(visit.Causes(), SizeIs(0));
}

std::map<std::string, double> Held(double files_a, double files_b, double captures, double with_board_a) {
  return {{"captures_total", captures},
          {"files_a", files_a},
          {"files_b", files_b},
          {"files_with_board_a", with_board_a},
          {"files_with_board_b", files_b}};
}

std::string MissingOf(const std::string& sensor, const Visit& visit) {
  for (const RootCause& cause : visit.Causes())
    if (cause.kind == CauseKind::kFilesMissing && cause.sensors.front() == SensorId(sensor)) return cause.said.why;
  return "";
}

// Top is in both passes, left in the first, right in the second.
TEST(MissingFiles, OfSensorsOfAnotherPassAreNotMissing) {
  Visit visit(StereoBoard());
  for (const char* camera : {"left", "right", "top"}) visit.AddSensor(camera, SensorKind::kCamera);
  visit.AddFailed("left", "top", "stereo", "too_few_captures", Held(20, 40, 40, 2));
  visit.AddGood("right", "top");
  visit.edges.back().figures = Held(20, 40, 40, 20);
  EXPECT_EQ(MissingOf("left", visit), "left has files for 20 of 40 captures") << "nothing tells of another pass";
  visit.AddFailed("left", "right", "stereo", "too_few_captures", Held(20, 20, 40, 20));
  EXPECT_EQ(MissingOf("left", visit), "");
  EXPECT_EQ(MissingOf("right", visit), "");
  visit.edges.front().figures["files_a"] = 12, visit.edges.back().figures["files_a"] = 12;
  visit.edges.back().figures["captures_total"] = 32;
  EXPECT_EQ(MissingOf("left", visit), "left has files for 12 of 20 captures");
  visit.edges.back().figures["captures_total"] = 31;  // one together
  EXPECT_EQ(MissingOf("left", visit), "left has files for 12 of 40 captures");
  visit.edges.back().figures["captures_total"] = 32;
  visit.edges[1].figures["captures_total"] = 45;  // right's pass is not top's
  EXPECT_EQ(MissingOf("left", visit), "left has files for 12 of 40 captures");
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

// Ten of twenty captures were enough: nothing failed, and half of what was taken is missing all the same.
TEST(FilesOfGoodPairs, AreMissedWhereACaptureInFourHasNone) {
  Visit visit(StereoBoard());
  const auto good = [&](const std::string& a, const std::string& b, double files_b) {
    Edge edge = MakeEdge('a', a, b);
    edge.figures = {{"captures_total", 20}, {"files_b", files_b}, {"files_with_board_b", files_b}};
    visit.Add(edge);
  };
  good("left", "right", 16);
  EXPECT_THAT(visit.Causes(), IsEmpty()) << "four of twenty";
  good("left", "top", 10);
  const RootCause cause = OneCause(visit, CauseKind::kFilesMissing);
  EXPECT_EQ(cause.said.why, "top has files for 10 of 20 captures");
  EXPECT_THAT(cause.edges, IsEmpty());
}

TEST(FewCaptures, OfASensorLeaveItUnknown) {
  Rig rig;
  rig.solution.poses.push_back(PoseOf("rear"));
  Edge edge = MakeEdge('d', "top", "rear");
  edge.session = SessionId(std::string(64, '1'));
  for (const char* capture : {"00", "01", "02"}) edge.captures.push_back({CaptureId(capture), 0.1, true, {}});
  rig.edges.push_back(edge);
  edge.frame_a = SensorId("left");
  rig.edges.push_back(edge);
  const Verdict verdict = rig.Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kUnknown);
  EXPECT_EQ(verdict.why, "Only 3 captures stand behind the pose of rear: too few to tell how well it is known.");
  EXPECT_EQ(verdict.unverified, "rear");
  edge.session = SessionId(std::string(64, '2'));
  rig.edges.push_back(edge);
  EXPECT_NE(rig.Judge().level, VerdictLevel::kUnknown) << "three of another day";
}

TEST(PositionsUnit, OneTrackerInMillimetresIsOneCause) {
  Visit visit(StereoBoard());
  for (const char* camera : {"left", "right", "top"})
    visit.AddFailed("body", camera, "hand_eye", "positions_in_millimetres",
                    {{"positions_step_a_m", camera[0] == 't' ? 310.2 : 250.0}});
  const RootCause cause = OneCause(visit, CauseKind::kPositionsUnit);
  EXPECT_THAT(cause.edges, SizeIs(3));
  EXPECT_THAT(cause.sensors, ElementsAre(SensorId("body")));
  EXPECT_EQ(cause.said.why, "the positions of body look like millimetres: up to 310 m from one capture to the next");
  EXPECT_EQ(cause.said.what_to_do, "Give the positions in body/poses.csv in metres");
}

}  // namespace
}  // namespace rigcal::fleet
