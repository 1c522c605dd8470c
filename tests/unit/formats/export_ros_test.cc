// What leaves for ROS and Autoware, read by urdfdom and yaml-cpp, and put together by the formulas of those formats.
#include <gmock/gmock.h>
#include <urdf_parser/urdf_parser.h>
#include <yaml-cpp/yaml.h>

#include "tests/unit/formats/export_sample.h"

namespace rigcal::exports {
namespace {

using sample::Points;
using sample::Rig;
using sample::TextOf;
using sample::Truth;
using testing::HasSubstr;

constexpr double kRounding = 1e-13;

// Fixed axes: first roll about x, then pitch about y, then yaw about z.
Eigen::Vector3d Turned(double roll, double pitch, double yaw, const Eigen::Vector3d& p) {
  const Eigen::Vector3d a(p.x(), std::cos(roll) * p.y() - std::sin(roll) * p.z(),
                          std::sin(roll) * p.y() + std::cos(roll) * p.z());
  const Eigen::Vector3d b(std::cos(pitch) * a.x() + std::sin(pitch) * a.z(), a.y(),
                          -std::sin(pitch) * a.x() + std::cos(pitch) * a.z());
  return {std::cos(yaw) * b.x() - std::sin(yaw) * b.y(), std::sin(yaw) * b.x() + std::cos(yaw) * b.y(), b.z()};
}

TEST(ExportUrdf, UrdfdomPutsEveryPointWhereTheCalibrationHasIt) {
  const urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(TextOf(WriteUrdf));
  ASSERT_TRUE(model);
  EXPECT_EQ(model->getName(), "mapper-01");
  EXPECT_EQ(model->getRoot()->name, "left");
  for (const auto& [name, truth] : Truth()) {
    if (name == "left") continue;
    const auto joint = model->getJoint(name + "_joint");
    ASSERT_TRUE(joint) << name;
    EXPECT_EQ(joint->parent_link_name, "left");
    EXPECT_EQ(joint->child_link_name, name);
    EXPECT_EQ(joint->type, urdf::Joint::FIXED);
    const urdf::Pose& origin = joint->parent_to_joint_origin_transform;
    for (const Eigen::Vector3d& p : Points()) {
      const urdf::Vector3 q = origin.rotation * urdf::Vector3(p.x(), p.y(), p.z());
      const Eigen::Vector3d p_left(q.x + origin.position.x, q.y + origin.position.y, q.z + origin.position.z);
      EXPECT_LT((p_left - truth * p).norm(), kRounding) << name;
    }
  }
}

TEST(ExportUrdf, SaysWhatItLeavesOutAndByWhichConvention) {
  const std::string text = TextOf(WriteUrdf);
  EXPECT_THAT(text, HasSubstr("robot mapper-01, revision 3 (in use)"));
  EXPECT_THAT(text, HasSubstr("Left out: tail: the height was not measured"));
  EXPECT_THAT(text, HasSubstr("R = Rz(yaw) Ry(pitch) Rx(roll)"));
  Calibration odd = Rig();
  odd.left_out = {"a--b ---> c"};
  EXPECT_TRUE(urdf::parseURDF(TextOf(WriteUrdf, odd))) << "a comment may not hold two dashes";
}

TEST(ExportTf2, TheQuaternionTurnsAPointOfTheChildIntoTheParent) {
  const YAML::Node transforms = YAML::Load(TextOf(WriteTf2))["transforms"];
  ASSERT_EQ(transforms.size(), 4U);
  for (const auto& one : transforms) {
    EXPECT_EQ(one["header"]["frame_id"].as<std::string>(), "left");
    const auto value = [&](const char* part, const char* axis) { return one["transform"][part][axis].as<double>(); };
    const Eigen::Vector3d v(value("rotation", "x"), value("rotation", "y"), value("rotation", "z"));
    const Eigen::Vector3d t(value("translation", "x"), value("translation", "y"), value("translation", "z"));
    const double w = value("rotation", "w");
    for (const Eigen::Vector3d& p : Points()) {  // p + 2 w (v x p) + 2 v x (v x p)
      const Eigen::Vector3d p_left = p + 2 * w * v.cross(p) + 2 * v.cross(v.cross(p)) + t;
      EXPECT_LT((p_left - Truth().at(one["child_frame_id"].as<std::string>()) * p).norm(), kRounding);
    }
  }
}

TEST(ExportTf2, TheLaunchFileNamesEveryNumber) {
  const std::string text = TextOf(WriteTf2Launch);
  EXPECT_THAT(
      text,
      HasSubstr(
          "--x -1.5 --y 0.75 --z 0.125 --qx 0.0 --qy 0.0 --qz 1.0 --qw 0.0 --frame-id left --child-frame-id lidar"));
  EXPECT_THAT(text, HasSubstr("pkg=\"tf2_ros\" exec=\"static_transform_publisher\""));
}

// YAML 1.1, which ROS reads by, takes 1e-05 for a word: it needs a point.
TEST(ExportTf2, NodesOfNamesThatDifferInTheirDashesAreTwo) {
  Calibration rig = Rig();
  ASSERT_TRUE(RenameFrames(rig, {{SensorId("right"), "a-b"}, {SensorId("lidar"), "a_b"}}));
  const std::string text = WriteTf2Launch(rig)->files.front().text;
  EXPECT_THAT(text, HasSubstr("name=\"static_transform_a_b\""));
  EXPECT_THAT(text, HasSubstr("name=\"static_transform_a_b__2\""));
}

TEST(ExportTf2, ASmallNumberIsANumberInYaml11) {
  EXPECT_THAT(TextOf(WriteTf2), HasSubstr("x: 1.0e-05, y: -3.0, z: 0.1"));
}

// Autoware's camera_link looks along x with z up; the optical frame in it has its z along that x, its x along -y, its y
// along -z.
TEST(ExportAutoware, ACameraIsItsBodyAndOthersAreThemselves) {
  const YAML::Node kit = YAML::Load(TextOf(WriteAutoware))["left"];
  ASSERT_EQ(kit.size(), 4U);
  for (const auto& [name, truth] : Truth()) {
    if (name == "left") continue;
    const bool camera = name == "right";
    const YAML::Node frame = kit[camera ? "right/camera_link" : name];
    ASSERT_TRUE(frame) << name;
    const auto value = [&](const char* key) { return frame[key].as<double>(); };
    for (const Eigen::Vector3d& p : Points()) {
      const Eigen::Vector3d p_frame = camera ? Eigen::Vector3d(p.z(), -p.x(), -p.y()) : p;
      const Eigen::Vector3d p_left = Turned(value("roll"), value("pitch"), value("yaw"), p_frame) +
                                     Eigen::Vector3d(value("x"), value("y"), value("z"));
      EXPECT_LT((p_left - truth * p).norm(), kRounding) << name;
    }
  }
}

TEST(ExportCameraInfo, HasAFilePerCameraAsRosReadsIt) {
  const auto written = WriteCameraInfo(Rig());
  ASSERT_TRUE(written);
  ASSERT_EQ(written->files.size(), 2U);
  EXPECT_EQ(written->files[1].name, "right.yaml");
  const YAML::Node left = YAML::Load(written->files[0].text), right = YAML::Load(written->files[1].text);
  EXPECT_EQ(left["image_width"].as<int>(), 640);
  EXPECT_EQ(left["camera_name"].as<std::string>(), "left");
  EXPECT_EQ(left["distortion_model"].as<std::string>(), "plumb_bob");
  EXPECT_EQ(left["distortion_coefficients"]["data"].as<std::vector<double>>(),
            (std::vector<double>{-0.25, 0.0625, 0.001, -0.002, 0.0}));
  EXPECT_EQ(left["camera_matrix"]["data"].as<std::vector<double>>(),
            (std::vector<double>{500.5, 0, 320.125, 0, 510.25, 239.75, 0, 0, 1}));
  EXPECT_EQ(left["projection_matrix"]["data"].as<std::vector<double>>(),
            (std::vector<double>{500.5, 0, 320.125, 0, 0, 510.25, 239.75, 0, 0, 0, 1, 0}));
  EXPECT_EQ(right["distortion_model"].as<std::string>(), "equidistant");
  EXPECT_EQ(right["distortion_coefficients"]["cols"].as<int>(), 4);
}

TEST(ExportCameraInfo, NamesACameraWithoutIntrinsicsAndRefusesARigWithoutAny) {
  Calibration rig = Rig();
  rig.sensors[1].camera.reset();
  const auto written = WriteCameraInfo(rig);
  ASSERT_TRUE(written);
  EXPECT_THAT(written->left_out, testing::Contains("right: a camera of which no intrinsics are known"));
  EXPECT_THAT(written->files[0].text, HasSubstr("# Left out: right: a camera of which no intrinsics are known"));
  rig.sensors[0].camera.reset();
  EXPECT_THAT(WriteCameraInfo(rig).error().what, HasSubstr("no camera of mapper-01 has intrinsics"));
}

}  // namespace
}  // namespace rigcal::exports
