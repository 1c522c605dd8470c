// Boards that a robot carries: which pairs there are with them, and what a session has to say of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/model/edges/method.h"
#include "server/model/sessions/session.h"

namespace rigcal {
namespace {

using ::testing::HasSubstr;

Sensor Of(const char* id, SensorKind kind, const char* sees = nullptr) {
  Sensor sensor;
  sensor.id = SensorId(id);
  sensor.kind = kind;
  if (sees) sensor.sees = TargetId(sees);
  return sensor;
}

// "cam arm eye_to_hand; cam top lidar_camera"
std::string PairsOf(const SessionHeader& header) {
  std::string text;
  const auto sensor = [&](const SensorId& id) {
    return *std::find_if(header.sensors.begin(), header.sensors.end(), [&](const Sensor& s) { return s.id == id; });
  };
  for (const SensorPair& pair : PairsToCalibrate(header))
    text += (text.empty() ? "" : "; ") + pair.a.str() + " " + pair.b.str() + " " +
            NameOf(MethodFor(header, sensor(pair.a), sensor(pair.b)).value());
  return text;
}

SessionHeader Cell() {
  SessionHeader header;
  header.robot = RobotId("cell-01");
  header.sensors = {Of("cam", SensorKind::kCamera, "wrist"), Of("arm", SensorKind::kTracker)};
  header.reference = SensorId("cam");
  header.targets = {{TargetId("wrist"), 9, 6, 0.025, 0.0, "A-17"}};
  header.targets[0].mounted_on = SensorId("arm");
  return header;
}

TEST(PairsToCalibrate, ABoardOnARobotIsSeenFromBesideIt) {
  SessionHeader header = Cell();
  ASSERT_TRUE(Validate(header)) << Sentence(Validate(header).error());
  EXPECT_EQ(PairsOf(header), "cam arm eye_to_hand");
  std::swap(header.sensors[0], header.sensors[1]);
  EXPECT_EQ(PairsOf(header), "arm cam eye_to_hand");
  header.targets[0].mounted_on.reset();
  EXPECT_EQ(PairsOf(header), "arm cam tracker_camera");
}

// What carries a board stands for its base; the same robot listed as a body of its own is the flange.
TEST(PairsToCalibrate, ARobotThatCarriesBoardAndCameraIsListedTwice) {
  SessionHeader header = Cell();
  header.targets.push_back({TargetId("floor"), 9, 6, 0.025, 0.0, ""});
  header.sensors.push_back(Of("hand", SensorKind::kCamera, "floor"));
  header.sensors.push_back(Of("flange", SensorKind::kTracker));
  header.sensors.push_back(Of("top", SensorKind::kLidar, "wrist"));
  ASSERT_TRUE(Validate(header)) << Sentence(Validate(header).error());
  EXPECT_EQ(PairsOf(header), "cam arm eye_to_hand; cam top lidar_camera; hand flange tracker_camera");
  header.targets[1].mounted_on = SensorId("arm");  // two boards on one flange
  EXPECT_EQ(PairsOf(header),
            "cam arm eye_to_hand; cam hand non_overlapping; cam top lidar_camera; arm hand eye_to_hand");
}

TEST(ValidateHeader, ABoardIsMountedOnATracker) {
  SessionHeader header = Cell();
  header.targets[0].mounted_on = SensorId("leg");
  EXPECT_EQ(Validate(header).error().what, "target wrist: it is mounted on \"leg\", which is not a sensor");
  header.targets[0].mounted_on = SensorId("cam");
  EXPECT_EQ(Validate(header).error().what, "target wrist: it is mounted on \"cam\", which is a camera");
  EXPECT_THAT(Validate(header).error().cure, HasSubstr("leave 'mounted_on' away if the board stands still"));
}

TEST(ValidateHeader, WhichOfABoardThatMovesAndOneThatStandsIsSeenIsSaid) {
  SessionHeader header = Cell();
  header.targets.push_back({TargetId("floor"), 9, 6, 0.025, 0.0, ""});
  EXPECT_TRUE(Validate(header));
  header.sensors[0].sees.reset();
  const Error error = Validate(header).error();
  EXPECT_EQ(error.what,
            "sensor cam: it may see target \"wrist\", which moves with arm, and target \"floor\", which stands still");
  EXPECT_EQ(error.cure, "Say which of them it looks at: 'sees: wrist' or 'sees: floor'.");
  header.targets[1].mounted_on = SensorId("arm");
  EXPECT_TRUE(Validate(header));
}

}  // namespace
}  // namespace rigcal
