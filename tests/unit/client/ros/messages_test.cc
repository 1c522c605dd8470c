// A calibration as messages of ROS 2: half turns, names, lenses, against values written out by hand.
#include "client/ros/messages.h"

#include <gmock/gmock.h>

#include "tests/unit/formats/export_sample.h"

namespace rigcal::client {
namespace {

using exports::sample::Rig;
using testing::ElementsAre;
using testing::HasSubstr;

exports::ExportedSensor CameraCalled(const std::string& name) {
  exports::ExportedSensor camera{SensorId(name), name, SensorKind::kCamera, {}};
  camera.camera = exports::sample::Camera(name, CameraModel::kPinholeRadtan, {0, 0, 0, 0, 0});
  return camera;
}

TEST(RosMessages, ATransformMapsPointsOfTheChildIntoTheRoot) {
  const exports::Calibration rig = Rig();
  const auto message = TransformsOf(rig, {1'700'000'000'000'000'001});
  ASSERT_EQ(message.sample.transforms._length, 4U) << "every sensor but the root";
  const char* const children[] = {"right", "lidar", "mast", "nose"};
  for (std::uint32_t i = 0; i < 4; ++i) {
    const auto& one = message.sample.transforms._buffer[i];
    EXPECT_STREQ(one.header.frame_id, "left");
    EXPECT_STREQ(one.child_frame_id, children[i]);
    EXPECT_EQ(one.header.stamp.sec, 1'700'000'000);
    EXPECT_EQ(one.header.stamp.nanosec, 1U);
    const auto& t = one.transform.translation;
    const auto& q = one.transform.rotation;
    const Eigen::Quaterniond rotation(q.w, q.x, q.y, q.z);
    EXPECT_NEAR(rotation.norm(), 1.0, 1e-15);
    for (const Eigen::Vector3d& point : exports::sample::Points())
      EXPECT_LT(
          (rotation * point + Eigen::Vector3d(t.x, t.y, t.z) - exports::sample::Truth().at(children[i]) * point).norm(),
          1e-12);
  }
  EXPECT_EQ(message.sample.transforms._buffer[1].transform.rotation.z, 1.0) << "half a turn";
  EXPECT_EQ(message.sample.transforms._buffer[1].transform.rotation.w, 0.0);
}

TEST(RosMessages, FramesAreThoseThatWereAskedFor) {
  exports::Calibration rig = Rig();
  ASSERT_TRUE(exports::RenameFrames(rig, {{SensorId("left"), "cam/optical"}, {SensorId("lidar"), "top_lidar_link"}}));
  const auto message = TransformsOf(rig);
  EXPECT_STREQ(message.sample.transforms._buffer[0].header.frame_id, "cam/optical");
  EXPECT_STREQ(message.sample.transforms._buffer[1].child_frame_id, "top_lidar_link");
  EXPECT_EQ(message.sample.transforms._buffer[0].header.stamp.sec, 0);
}

TEST(RosMessages, CameraInfoHasTheLensOfTheFile) {
  const exports::Calibration rig = Rig();
  const auto message = CameraInfoOf(rig.sensors[0]);
  const wire::RosCameraInfo& info = message.sample;
  EXPECT_STREQ(info.header.frame_id, "left");
  EXPECT_STREQ(info.distortion_model, "plumb_bob");
  EXPECT_EQ(info.width, 640U);
  EXPECT_EQ(info.height, 480U);
  EXPECT_THAT(std::vector<double>(info.d._buffer, info.d._buffer + info.d._length),
              ElementsAre(-0.25, 0.0625, 0.001, -0.002, 0.0));
  EXPECT_THAT(info.k, ElementsAre(500.5, 0, 320.125, 0, 510.25, 239.75, 0, 0, 1));
  EXPECT_THAT(info.r, ElementsAre(1, 0, 0, 0, 1, 0, 0, 0, 1));
  EXPECT_THAT(info.p, ElementsAre(500.5, 0, 320.125, 0, 0, 510.25, 239.75, 0, 0, 0, 1, 0));
  EXPECT_EQ(info.roi.width, 0U);
  EXPECT_STREQ(CameraInfoOf(rig.sensors[1]).sample.distortion_model, "equidistant");
  EXPECT_EQ(CameraInfoOf(rig.sensors[1]).sample.d._length, 4U);
}

TEST(RosMessages, TopicsOfCamerasAreNamesThatRos2Allows) {
  const exports::ExportedSensor a = CameraCalled("front-left.2"), b = CameraCalled("360"), c = CameraCalled("_rear--x");
  const auto topics = CameraTopics({&a, &b, &c});
  ASSERT_TRUE(topics);
  std::vector<std::string> names;
  for (const auto& [topic, camera] : *topics) names.push_back(topic);
  EXPECT_THAT(names,
              ElementsAre("rt/camera_360/camera_info", "rt/camera_rear_x/camera_info", "rt/front_left_2/camera_info"));
}

TEST(RosMessages, TwoCamerasDoNotShareATopic) {
  const exports::ExportedSensor a = CameraCalled("front-left"), b = CameraCalled("front.left");
  const auto topics = CameraTopics({&a, &b});
  ASSERT_FALSE(topics);
  EXPECT_THAT(topics.error().what,
              HasSubstr("cameras 'front-left' and 'front.left' would both have the topic rt/front_left/camera_info"));
}

}  // namespace
}  // namespace rigcal::client
