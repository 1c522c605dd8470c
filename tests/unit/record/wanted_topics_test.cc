#include "client/record/wanted_topics.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "client/bags/messages/definition.h"

namespace rigcal::recording {
namespace {

using testing::HasSubstr;

importing::RigMap Map(const std::string& sensors) {
  const std::string text =
      "format: 1\nrobot: r\ntargets:\n  board: {type: checkerboard, inner_corners: [9, 6], square_size_m: "
      "0.025}\nsensors:\n" +
      sensors;
  const auto map = importing::ReadRigMap(text, "rig.yaml");
  EXPECT_TRUE(map) << map.error().what;
  return map.value_or(importing::RigMap{});
}

const char* const kRig =
    "  left: {type: camera, topic: /left, sees: board}\n  top: {type: lidar, topic: /top}\n"
    "  tool: {type: tracker, topic: /tf, frame: base, child_frame: tool}\n  arm: {type: tracker, topic: /tf, frame: "
    "base, child_frame: "
    "arm}\n";

TEST(WantedTopics, EachOnceAndStaticFramesWhereFramesAreWanted) {
  const auto wanted = WantedTopics(Map(kRig));
  ASSERT_EQ(wanted.size(), 4U);
  EXPECT_EQ(NameFor(wanted[0]), "/left (left)");
  EXPECT_EQ(NameFor(wanted[2]), "/tf (tool, arm)");
  EXPECT_EQ(wanted[3].name, "/tf_static");
  EXPECT_TRUE(wanted[3].IsOptional());
  EXPECT_FALSE(wanted[2].IsOptional());
  EXPECT_EQ(WantedTopics(Map("  left: {type: camera, topic: /left, sees: board}\n")).size(), 1U);
}

TEST(WantedTopics, TypesThatImportTakesAndNoOthers) {
  const auto wanted = WantedTopics(Map(kRig));
  const std::vector<std::pair<std::size_t, std::string>> fitting = {
      {0, "sensor_msgs/msg/Image"},     {0, "sensor_msgs/msg/CompressedImage"}, {1, "sensor_msgs/msg/PointCloud2"},
      {1, "sensor_msgs/msg/LaserScan"}, {2, "tf2_msgs/msg/TFMessage"},          {3, "tf2_msgs/msg/TFMessage"}};
  for (const auto& [topic, type] : fitting) EXPECT_FALSE(WhyNot(wanted[topic], type)) << type;
  for (const auto& [topic, type] : fitting)
    for (std::size_t other = 0; other < 3; ++other) {
      if (other == std::min<std::size_t>(topic, 2)) continue;
      EXPECT_TRUE(WhyNot(wanted[other], type)) << type << " for " << wanted[other].name;
    }
  const auto why_not = WhyNot(wanted[0], "sensor_msgs/msg/PointCloud2");
  ASSERT_TRUE(why_not);
  EXPECT_THAT(why_not->what, HasSubstr("/left (left) is published as sensor_msgs/msg/PointCloud2"));
  EXPECT_THAT(why_not->what, HasSubstr("Image or sensor_msgs/msg/CompressedImage"));
  EXPECT_THAT(why_not->cure, HasSubstr("rig.yaml"));
}

TEST(WantedTopics, PosesAreTakenWithoutFramesOnly) {
  const auto wanted = WantedTopics(Map("  body: {type: pose_stream, topic: /pose}\n"));
  for (const char* type : {"geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/PoseWithCovarianceStamped",
                           "geometry_msgs/msg/TransformStamped", "nav_msgs/msg/Odometry"})
    EXPECT_FALSE(WhyNot(wanted[0], type)) << type;
  EXPECT_TRUE(WhyNot(wanted[0], "tf2_msgs/msg/TFMessage")) << "whose pose is not said";
}

// Every type that is recorded has its definition in the bag: else import could not decode it.
TEST(WantedTopics, ABagsTopicHasItsDefinition) {
  for (const WantedTopic& topic : WantedTopics(Map(kRig)))
    for (const char* type : {"sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage", "sensor_msgs/msg/PointCloud2",
                             "sensor_msgs/msg/LaserScan", "tf2_msgs/msg/TFMessage"}) {
      if (WhyNot(topic, type)) continue;
      const bags::Topic of = BagTopicOf(topic.name, type);
      EXPECT_FALSE(of.schema.empty()) << type;
      EXPECT_EQ(of.encoding, "cdr");
      EXPECT_TRUE(bags::DefinitionOf(of)) << type;
    }
}

}  // namespace
}  // namespace rigcal::recording
