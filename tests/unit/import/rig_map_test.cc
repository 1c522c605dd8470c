#include "client/import/rig_map.h"

#include <gmock/gmock.h>

#include "server/formats/sessions/session_folder.h"

namespace rigcal::importing {
namespace {

using ::testing::HasSubstr;

constexpr const char* kRig =
    "format: 1\nrobot: mapper-01\nimport: {tolerance_s: 0.002, every_s: 1.5}\n"
    "targets:\n  board: {type: checkerboard, inner_corners: [9, 6], square_size_m: 0.025, serial: \"no: 7 # of us\"}\n"
    "sensors:\n  left: {type: camera, topic: /left, sees: board}\n"
    "  flange: {type: tracker, topic: /tf, frame: base, child_frame: tool, stamp: log}\n"
    "conditions:\n  place: \"hall: 2\"\n";

TEST(RigMap, IsSessionYamlWithTopics) {
  const auto map = ReadRigMap(kRig, "rig.yaml");
  ASSERT_TRUE(map) << map.error().what;
  ASSERT_EQ(map->sensors.size(), 2U);
  EXPECT_EQ(map->tolerance_ns, 2'000'000);
  EXPECT_EQ(map->every_ns, 1'500'000'000);
  EXPECT_EQ(map->sensors[1].child_frame, "tool");
  EXPECT_EQ(map->sensors[1].stamp, StampSource::kLog);
  const auto header = formats::ReadSessionYaml(SessionYaml(*map, Stamp{1'700'000'000'000'000'000}), "session.yaml");
  ASSERT_TRUE(header) << header.error().what;
  EXPECT_EQ(header->captured_at.ns, 1'700'000'000'000'000'000);
  EXPECT_EQ(header->conditions.at("place"), "hall: 2");
  EXPECT_EQ(header->targets[0].serial, "no: 7 # of us");
  EXPECT_EQ(header->sensors[0].sees->str(), "board");
}

TEST(RigMap, WrongOnesAreRefusedByName) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string text = kRig;
    return text.replace(text.find(from), from.size(), to);
  };
  const std::pair<std::string, const char*> cases[] = {
      {with("topic: /left, ", ""), "topic"},
      {with("tolerance_s: 0.002", "tolerance_s: 5"), "tolerance_s"},
      {with("tolerance_s", "tolerence_s"), "tolerence_s"},
      {with("child_frame: tool, ", ""), "belong together"},
      {with("stamp: log", "stamp: clock"), "header or log"},
      {with("type: camera", "type: radar"), "radar"},
      {with("sees: board", "sees: wall"), "wall"},
      {with("robot: mapper-01", "robot:"), "robot"},
      {with("format: 1", "format: 1\ncaptured_at: 2026-01-31"), "captured_at"},
      {with("topic: /tf, frame: base, child_frame: tool", "topic: /left"), "two sensors have the topic"},
  };
  for (const auto& [text, word] : cases) {
    const auto map = ReadRigMap(text, "rig.yaml");
    ASSERT_FALSE(map) << text;
    EXPECT_THAT(map.error().what, HasSubstr(word));
    EXPECT_THAT(map.error().what, HasSubstr("rig.yaml"));
  }
}

TEST(RigMap, TheFirstOneAsksForWhatABagCannotTell) {
  BagSurvey survey;
  const auto add = [&](const std::string& name, const std::string& type, const std::string& kind,
                       const std::string& lens = "") {
    TopicSurvey topic;
    topic.name = name;
    topic.type = type;
    topic.sensor_kind = kind;
    topic.lens_model = lens;
    topic.count = 10;
    survey.topics.push_back(topic);
  };
  add("/left/camera_info", "sensor_msgs/msg/CameraInfo", "", "fisheye_kb4");
  add("/left/image_raw", "sensor_msgs/msg/Image", "camera");
  add("/left/image_raw/compressed", "sensor_msgs/msg/CompressedImage", "camera");
  add("/odom", "nav_msgs/msg/Odometry", "pose_stream");
  add("/sensing/lidar/points", "sensor_msgs/msg/PointCloud2", "lidar");
  add("/rosout", "rcl_interfaces/msg/Log", "");
  std::string text = FirstRigYaml(survey);
  EXPECT_FALSE(ReadRigMap(text, "rig.yaml"));
  text.replace(text.find("robot: "), 7, "robot: r");
  text.replace(text.find("  # board"), 9, "  board");
  const auto map = ReadRigMap(text, "rig.yaml");
  ASSERT_TRUE(map) << map.error().what << "\n" << text;
  ASSERT_EQ(map->sensors.size(), 3U) << text;
  EXPECT_EQ(map->sensors[0].id.str(), "left");
  EXPECT_EQ(map->sensors[2].id.str(), "sensing_lidar");
  EXPECT_THAT(text, HasSubstr("model: fisheye_kb4"));
}

}  // namespace
}  // namespace rigcal::importing
