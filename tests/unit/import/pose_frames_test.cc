// Whose poses are taken for a sensor, and when none are.
#include "client/import/pose_frames.h"

#include <gtest/gtest.h>

namespace rigcal::importing {
namespace {

bags::StampedPose Pose(std::int64_t stamp_ns, const std::string& frame, const std::string& child, double x_m) {
  return {{stamp_ns, frame}, child, {{x_m, 0, 0}, Eigen::Quaterniond::Identity()}};
}
MappedSensor Sensor(const std::string& topic, const std::string& frame = "", const std::string& child = "") {
  MappedSensor sensor;
  sensor.id = SensorId("s"), sensor.kind = SensorKind::kTracker, sensor.topic = topic;
  sensor.frame = frame, sensor.child_frame = child;
  return sensor;
}

TEST(PoseFrames, OfATopicWithTwoBodiesEachSensorHasItsOwn) {
  const MappedSensor rig = Sensor("/vicon", "world", "rig"), wand = Sensor("/vicon", "world", "wand");
  PoseFrames of_rig(rig), of_wand(wand);
  for (const bags::StampedPose& one : {Pose(1, "/world", "rig", 1), Pose(1, "world", "/wand", 100)}) {
    const auto taken = of_rig.Take(one);
    EXPECT_EQ(taken.has_value(), one.child == "rig");
    EXPECT_EQ(of_wand.Take(one).has_value(), one.child == "/wand");
  }
  EXPECT_EQ(of_rig.Doubt() + of_wand.Doubt(), "");
}

TEST(PoseFrames, WhereTwoBodiesShareATopicAndNothingTellsThemApartNeitherIsTaken) {
  const MappedSensor sensor = Sensor("/vicon");
  PoseFrames frames(sensor);
  EXPECT_TRUE(frames.Take(Pose(1, "world", "rig", 1)));
  EXPECT_EQ(frames.Doubt(), "");
  EXPECT_TRUE(frames.Take(Pose(1, "world", "wand", 100)));
  EXPECT_EQ(
      frames.Doubt(),
      "its topic has the pose of \"rig\" in \"world\" and the pose of \"wand\" in \"world\": nothing tells which is "
      "meant. Set `frame` and `child_frame` in rig.yaml");
}

TEST(PoseFrames, AFrameThatChangesHalfWayIsInDoubtUnlessOneIsAskedFor) {
  const MappedSensor any = Sensor("/pose"), in_map = Sensor("/pose", "map", "rig");
  PoseFrames open(any), asked(in_map);
  for (const bags::StampedPose& one : {Pose(1, "odom", "", 1), Pose(2, "map", "", 50)}) {
    EXPECT_TRUE(open.Take(one));
    EXPECT_EQ(asked.Take(one).has_value(), one.header.frame == "map");
  }
  EXPECT_NE(open.Doubt(), "");
  EXPECT_EQ(asked.Doubt(), "");
}

TEST(PoseFrames, TheOtherWayRoundIsNotTaken) {
  const MappedSensor sensor = Sensor("/vicon", "rig", "world");
  PoseFrames frames(sensor);
  EXPECT_FALSE(frames.Take(Pose(1, "world", "rig", 1)));
  EXPECT_EQ(frames.WhyNone(),
            "its topic has the pose of \"rig\" in \"world\", and not that of \"world\" in \"rig\", as rig.yaml says");
}

TEST(PoseFrames, StaticTransformsOfAnotherRobotAreNotTaken) {
  const MappedSensor sensor = Sensor("/r1/tf", "base", "tool");
  PoseFrames frames(sensor);
  frames.TakeStatic("/r1/tf_static", {Pose(0, "flange", "tool", 0.1)});
  frames.TakeStatic("/r2/tf_static", {Pose(0, "flange", "tool", 0.5)});
  auto pose = frames.Take({Pose(5, "base", "flange", 1)}, 10);
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->T_frame_child.p_m.x(), 1.1, 1e-12);
  EXPECT_EQ(frames.Doubt(), "");
  frames.TakeStatic("/tf_static", {Pose(0, "flange", "tool", 0.5)});  // of all robots
  EXPECT_EQ(frames.Doubt(), "the transform of \"tool\" in \"flange\" is said to be static, and came with two values");
}

TEST(PoseFrames, AMessageThatMovesNothingBetweenIsNoPose) {
  const MappedSensor sensor = Sensor("/tf", "base", "tool");
  PoseFrames frames(sensor);
  EXPECT_TRUE(frames.Take({Pose(5, "base", "tool", 1)}, 10));
  EXPECT_FALSE(frames.Take({Pose(6, "base", "wheel", 1)}, 10));
}

TEST(FrameTree, AFrameWithTwoAboveItIsInDoubt) {
  FrameTree tree;
  tree.Add(Pose(1, "left", "tool", 0), false);
  EXPECT_EQ(tree.Doubt("left", "tool"), "");
  tree.Add(Pose(2, "right", "tool", 2), false);
  tree.Add(Pose(3, "left", "tool", 0), false);
  EXPECT_EQ(tree.Doubt("left", "tool"), "the frame \"tool\" is in \"left\" and in \"right\": a frame has one above it");
}

TEST(FrameTree, AStaticTransformMayBeSaidAgain) {
  FrameTree tree;
  tree.Add(Pose(1, "flange", "tool", 0.1), true);
  tree.Add(Pose(2, "flange", "tool", 0.1), true);
  EXPECT_EQ(tree.Doubt("flange", "tool"), "");
  tree.Add(Pose(3, "flange", "tool", 0.2), false);
  EXPECT_NE(tree.Doubt("flange", "tool"), "");
}

TEST(FrameTree, TellsWhyThereIsNoPose) {
  FrameTree tree;
  tree.Add(Pose(100, "base", "arm", 1), false);
  tree.Add(Pose(900, "arm", "tool", 1), false);
  tree.Add(Pose(0, "tool", "camera", 1), true);
  EXPECT_EQ(tree.WhyNone("base", "gripper"), "no transform is of or in a frame \"gripper\"");
  EXPECT_EQ(tree.WhyNone("camera", "arm"), "\"arm\" is not below \"camera\": above it is \"base\"");
  EXPECT_EQ(tree.WhyNone("camera", "base"), "\"base\" is not below \"camera\": above it is nothing");
  EXPECT_EQ(tree.WhyNone("tool", "camera"),
            "all transforms from \"tool\" to \"camera\" are static: nothing tells when it was where");
  EXPECT_EQ(tree.WhyNone("base", "tool"),
            "the transforms from \"base\" to \"tool\" are never within `tolerance_s` of each other");
}

}  // namespace
}  // namespace rigcal::importing
