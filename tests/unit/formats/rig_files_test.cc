// Files of other programs as frames, and edges made from them: poses written out by hand, and what our own writers
// give.
#include <gmock/gmock.h>

#include "server/formats/rig_files/assumed_edges.h"
#include "server/formats/rig_files/frames.h"
#include "tests/unit/formats/export_sample.h"

namespace rigcal::rig_files {
namespace {

using exports::sample::Points;
using exports::sample::Rig;
using exports::sample::TextOf;
using exports::sample::Truth;
using testing::HasSubstr;

void ExpectTruth(const std::string& text, const std::string& root, std::size_t frames) {
  const auto file = ReadRigFile(text, "file");
  ASSERT_TRUE(file) << file.error().what;
  const auto poses = PosesIn(*file, root);
  ASSERT_TRUE(poses) << poses.error().what;
  EXPECT_EQ(poses->size(), frames);
  for (const auto& [frame, pose] : *poses)
    for (const Eigen::Vector3d& p : Points())
      EXPECT_LT((pose * p - Truth().at(root).Back(Truth().at(frame) * p)).norm(), 1e-13) << frame;
}

TEST(RigFiles, WhatWasWrittenIsReadBackInAnyRoot) {
  for (const auto* root : {"left", "lidar", "nose"})
    for (const exports::Writer writer : {exports::WriteUrdf, exports::WriteTf2, exports::WriteAutoware})
      ExpectTruth(TextOf(writer), root, 5);
  ExpectTruth(TextOf(exports::WriteKalibr), "right", 2);
}

TEST(RigFiles, AKalibrChainIsFollowedByItsNumbers) {
  // p_cam1 = p_cam0 + (1, 0, 0), p_cam2 = p_cam1 + (0, 1, 0), ...: cam10 comes before cam2 in the file.
  std::string text = "cam0: {resolution: [1, 1]}\n";
  for (const int n : {1, 10, 2, 3, 4, 5, 6, 7, 8, 9})
    text += "cam" + std::to_string(n) +
            ":\n  T_cn_cnm1:\n    - [1, 0, 0, 1]\n    - [0, 1, 0, 0]\n    - [0, 0, 1, 0]\n    - [0, 0, 0, 1]\n";
  const auto poses = PosesIn(*ReadRigFile(text, "camchain.yaml"), "cam0");
  ASSERT_TRUE(poses);
  EXPECT_NEAR(poses->at("cam10").p_m.x(), -10, 1e-12);
}

TEST(RigFiles, AMovingJointTiesNothing) {
  const std::string text =
      "<robot name='r'><link name='a'/><link name='b'/><link name='c'/>"
      "<joint name='j' type='revolute'><parent link='a'/><child link='b'/></joint>"
      "<joint name='k' type='fixed'><origin xyz='1 2 3'/><parent link='b'/><child link='c'/></joint></robot>";
  const auto file = ReadRigFile(text, "r.urdf");
  ASSERT_TRUE(file);
  EXPECT_EQ(PosesIn(*file, "b")->size(), 2U);
  EXPECT_EQ(PosesIn(*file, "a")->size(), 1U);
  EXPECT_THAT(PosesIn(*file, "d").error().cure, HasSubstr("a, b, c"));
}

TEST(RigFiles, WhatIsWrongIsNamed) {
  const auto what = [](const std::string& text) {
    const auto file = ReadRigFile(text, "f");
    const auto poses = file ? PosesIn(*file, file->poses.front().parent) : Fail(file.error());
    return poses ? std::string("good") : poses.error().what + ". " + poses.error().cure;
  };
  const std::string joint =
      "<joint name='j' type='fixed'><origin xyz='0 0 1e9'/><parent link='a'/><child link='b'/></joint>";
  EXPECT_THAT(what(""), HasSubstr("f is empty"));
  EXPECT_THAT(what("<robot><joint"), HasSubstr("f line 1: no XML"));
  EXPECT_THAT(what("<a/>"), HasSubstr("there is no <robot>"));
  EXPECT_THAT(what("<robot xmlns:xacro='x'>\n<xacro:include filename='a'/></robot>"),
              HasSubstr("line 2: a xacro file that is not expanded. `xacro f > robot.urdf`"));
  EXPECT_THAT(what("<robot>" + joint + "</robot>"), HasSubstr("joint 'j'"));
  EXPECT_THAT(what("<robot><joint name='j'><origin xyz='1 nan 2'/><parent link='a'/><child link='b'/></joint></robot>"),
              HasSubstr("xyz must be three numbers"));
  EXPECT_THAT(
      what("<robot><joint name='j'><origin xyz='${x} 0 0'/><parent link='a'/><child link='b'/></joint></robot>"),
      HasSubstr("not expanded"));
  EXPECT_THAT(what("<robot><joint name='j'><parent link='a'/></joint></robot>"),
              HasSubstr("lacks its parent or child"));
  EXPECT_THAT(what("a: {b: {x: 0, y: 0, z: 0, roll: 0, pitch: 0}}"), HasSubstr("yaw"));
  EXPECT_THAT(what("a: {b: {x: 0, y: 0, z: .nan, roll: 0, pitch: 0, yaw: 0}}"), HasSubstr("'b'"));
  EXPECT_THAT(what("cam0: {}\ncam2: {T_cn_cnm1: []}\n"), HasSubstr("cam1 is missing before it"));
  EXPECT_THAT(what("cam0: {}\ncam1: {T_cn_cnm1: [[2, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}\n"),
              HasSubstr("is no rotation and translation"));
  EXPECT_THAT(what("transforms: [{header: {frame_id: a}, child_frame_id: b, transform: {translation: {x: 0, y: 0, z: "
                   "0}, rotation: {x: 0, y: 0, z: 0, w: 2}}}]"),
              HasSubstr("unit length"));
  const std::string pose = "{x: 0, y: 0, z: 0, roll: 0, pitch: 0, yaw: 0}";
  EXPECT_THAT(what("a: {b: " + pose + "}\nb: {a: " + pose + "}\n"), HasSubstr("stands below itself"));
  EXPECT_THAT(what("a: {c: " + pose + "}\nb: {c: " + pose + "}\n"),
              HasSubstr("stands below 'a' and once more below 'b'"));
}

TEST(RigFiles, DegreesAndKeysThatNoFrameHasAreRefused) {
  const auto what = [](const std::string& text) {
    const auto file = ReadRigFile(text, "f");
    return file ? std::string("good") : file.error().what;
  };
  const auto urdf = [](const std::string& rpy) {
    return "<robot><joint name='j' type='fixed'><origin xyz='0 0 1' rpy='" + rpy +
           "'/><parent link='a'/><child link='b'/></joint></robot>";
  };
  EXPECT_THAT(what(urdf("0 0 90")), HasSubstr("joint 'j': an angle of 90 is more than a whole turn in radians"));
  EXPECT_EQ(what(urdf("-6.2832 3.1416 0")), "good");
  EXPECT_THAT(what("a: {b: {x: 0, y: 0, z: 0, roll: 0, pitch: 0, yaw: -180}}"), HasSubstr("are these degrees?"));
  EXPECT_THAT(what("a: {b: {x: 0,5, y: 0, z: 0, roll: 0, pitch: 0, yaw: 0}}"), HasSubstr("unknown key \"5\""));
}

TEST(RigFiles, AFrameMayBeNamedAsAutowaresTextHasIt) {
  const auto kit = ReadRigFile("a: {c/camera_link: {x: 0, y: 0, z: 0, roll: 0, pitch: 0, yaw: 0}}", "f");
  ASSERT_TRUE(kit) << Sentence(kit.error());
  EXPECT_EQ(FrameAsRead(*kit, "c/camera_link"), kit->poses.front().frame);
  EXPECT_EQ(FrameAsRead(*kit, "c"), "c");
  EXPECT_EQ(FrameAsRead({"urdf", {}}, "c/camera_link"), "c/camera_link");
}

TEST(AssumedEdges, AreMeasuredFromTheFirstWithTheStatedSigma) {
  const auto file = ReadRigFile(TextOf(exports::WriteTf2), "f");
  ASSERT_TRUE(file);
  const auto sigma = ParseAssumedSigma("5,0.5");
  ASSERT_TRUE(sigma);
  const auto edges =
      AssumedEdges(*file, RobotId("r"), {{SensorId("top"), "lidar"}, {SensorId("eye"), "right"}}, *sigma);
  ASSERT_TRUE(edges) << edges.error().what;
  ASSERT_EQ(edges->size(), 1U);
  const Edge& edge = edges->front();
  EXPECT_EQ(edge.frame_a, SensorId("top"));
  EXPECT_EQ(edge.frame_b, SensorId("eye"));
  for (const Eigen::Vector3d& p : Points())
    EXPECT_LT((edge.T_a_b * p - Truth().at("lidar").Back(Truth().at("right") * p)).norm(), 1e-13);
  EXPECT_NEAR(edge.uncertainty.covariance(2, 2), 25e-6, 1e-15);
  EXPECT_NEAR(std::sqrt(edge.uncertainty.covariance(3, 3)) * 180 / M_PI, 0.5, 1e-12);
  EXPECT_EQ(edge.uncertainty.source, UncertaintySource::kAssumed);
  EXPECT_FALSE(edge.id.empty());
}

TEST(AssumedEdges, SayWhatTheyNeed) {
  for (const auto* text : {"5", "5,", ",1", "0,1", "5,-1", "5;1", "nan,1", "5,1x"})
    EXPECT_FALSE(ParseAssumedSigma(text)) << text;
  EXPECT_FALSE(ParseSensorFrame("left="));
  EXPECT_EQ(ParseSensorFrame("left=a=b")->frame, "a=b");
  const auto urdf = ReadRigFile(TextOf(exports::WriteUrdf), "f"), tf2 = ReadRigFile(TextOf(exports::WriteTf2), "f");
  EXPECT_THAT(AllFrames(*urdf).error().cure, HasSubstr("--frame SENSOR"));
  EXPECT_EQ(AllFrames(*tf2)->size(), 5U);
  EXPECT_THAT(AssumedEdges(*tf2, RobotId("r"), {{SensorId("a"), "left"}}, {1, 1}).error().what,
              HasSubstr("fewer than two"));
  EXPECT_THAT(AssumedEdges(*tf2, RobotId("r"), {{SensorId("a"), "left"}, {SensorId("b"), "tail"}}, {1, 1}).error().what,
              HasSubstr("'tail'"));
}

}  // namespace
}  // namespace rigcal::rig_files
