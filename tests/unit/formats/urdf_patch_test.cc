// A calibration in an existing robot: nothing but origins changes, and urdfdom finds every sensor where it belongs.
#include "server/formats/rig_files/urdf_patch.h"

#include <gmock/gmock.h>
#include <urdf_parser/urdf_parser.h>

#include "server/formats/rig_files/frames.h"
#include "tests/unit/formats/export_sample.h"
#include "tests/unit/formats/samples.h"
#include "tests/unit/recordings.h"

namespace rigcal::rig_files {
namespace {

using testing::HasSubstr;

// p_top = R p + t of a link, along its chain of joints, as urdfdom reads it.
Eigen::Vector3d OnTop(const urdf::ModelInterface& model, const std::string& link, const Eigen::Vector3d& p_link) {
  urdf::Vector3 p(p_link.x(), p_link.y(), p_link.z());
  for (auto at = model.getLink(link); at && at->parent_joint; at = at->getParent()) {
    const urdf::Pose& origin = at->parent_joint->parent_to_joint_origin_transform;
    const urdf::Vector3 turned = origin.rotation * p;
    p = urdf::Vector3(turned.x + origin.position.x, turned.y + origin.position.y, turned.z + origin.position.z);
  }
  return {p.x, p.y, p.z};
}

// Three points of a link are its pose.
Eigen::Vector3d InRoot(const urdf::ModelInterface& model, const std::string& root, const Eigen::Vector3d& p_top) {
  const Eigen::Vector3d o = OnTop(model, root, {0, 0, 0});
  return {(OnTop(model, root, {1, 0, 0}) - o).dot(p_top - o), (OnTop(model, root, {0, 1, 0}) - o).dot(p_top - o),
          (OnTop(model, root, {0, 0, 1}) - o).dot(p_top - o)};
}

LinkPoses Wanted(const std::string& root) {
  LinkPoses wanted{root, {}};
  for (const auto& sensor : exports::sample::Rig().sensors) wanted.poses.emplace(sensor.frame, sensor.T_root_sensor);
  return wanted;
}

// Whether a link above it is one of those.
bool IsBelow(const urdf::ModelInterface& model, const std::string& link, const LinkPoses& those) {
  for (auto at = model.getLink(link); at; at = at->getParent())
    if (those.poses.contains(at->name)) return true;
  return false;
}

// left hangs below mast, and a bracket is between mast and nose; a cover hangs below lidar.
constexpr const char* kRobot = R"(<?xml version="1.0"?>
<!-- a > b -->
<robot name="rig">
  <link name="base"/><link name="left"/> <link name="right"/>
  <link name="mast"/><link name="lidar"/><link name="nose"/><link name="bracket"/><link name="cover"/>
  <joint name="m" type="fixed"><origin rpy="0 0 0.5"   xyz='1 2 3'/><parent link="base"/><child link="mast"/></joint>
  <joint name="l" type='fixed' note="x > y">
    <parent link="mast"/>
    <child link="left"/>
  </joint>
  <joint name="b" type="fixed"><parent link="mast"/><child link="bracket"/><origin xyz="0 0 0.25"/></joint>
  <joint name="n" type="fixed"><parent link="bracket"/><child link="nose"/><origin rpy="0 0 0"></origin></joint>
  <joint name="d" type="fixed"><parent link="base"/><child link="lidar"/><origin extra="1" xyz="0 0 1" rpy="0 0 0"/></joint>
  <joint name="c" type="fixed"><parent link="lidar"/><child link="cover"/><origin xyz="0 0 0.1"/></joint>
  <joint name="r" type="revolute"><parent link="base"/><child link="right"/><axis xyz="0 0 1"/><limit effort="1" velocity="1" lower="0" upper="1"/></joint>
</robot>
)";

TEST(UrdfPatch, PutsEverySensorWhereItBelongsAndTheRootStays) {
  const auto patched = PatchUrdf(kRobot, "rig.urdf", Wanted("left"));
  ASSERT_TRUE(patched) << patched.error().what;
  const auto before = urdf::parseURDF(kRobot), after = urdf::parseURDF(patched->text);
  ASSERT_TRUE(before && after) << patched->text;
  for (const Eigen::Vector3d& p : exports::sample::Points()) {
    EXPECT_LT((OnTop(*before, "left", p) - OnTop(*after, "left", p)).norm(), 1e-12) << "the root";
    for (const auto* link : {"mast", "lidar", "nose"})
      EXPECT_LT((InRoot(*after, "left", OnTop(*after, link, p)) - exports::sample::Truth().at(link) * p).norm(), 1e-12)
          << link;
  }
  EXPECT_THAT(patched->left_out, testing::ElementsAre("right: joint 'r' above it moves"));
  ASSERT_EQ(patched->changes.size(), 4U) << "m, l (which has none), n and d";
  EXPECT_EQ(patched->changes[0].before, R"(<origin rpy="0 0 0.5"   xyz='1 2 3'/>)");
  EXPECT_EQ(patched->changes[0].line, 6U);
  EXPECT_THAT(patched->text, HasSubstr("\n    <origin "));
  EXPECT_THAT(patched->text, HasSubstr("extra=\"1\" xyz="));
}

// What stands between origins is byte-equal.
TEST(UrdfPatch, NoOtherByteChanges) {
  const std::string text(kRobot);
  const auto patched = PatchUrdf(text, "rig.urdf", Wanted("left"));
  ASSERT_TRUE(patched);
  std::string undone = patched->text;
  for (const OriginChange& change : patched->changes) {
    const std::string after = change.before.empty() ? "\n    " + change.after : change.after;
    const std::size_t at = undone.find(after);
    ASSERT_NE(at, std::string::npos) << change.joint;
    undone.replace(at, after.size(), change.before);
  }
  EXPECT_EQ(undone, text);
  const auto again = PatchUrdf(patched->text, "rig.urdf", Wanted("left"));
  ASSERT_TRUE(again);
  EXPECT_TRUE(again->changes.empty()) << again->changes[0].joint;
  EXPECT_EQ(again->text, patched->text);
}

TEST(UrdfPatch, SaysWhatItCannotDo) {
  LinkPoses wanted = Wanted("tail");
  EXPECT_THAT(PatchUrdf(kRobot, "rig.urdf", wanted).error().what, HasSubstr("rig.urdf has no link 'tail'"));
  EXPECT_THAT(PatchUrdf(kRobot, "rig.urdf", wanted).error().cure, HasSubstr("base, bracket"));
  wanted = {"left", {{"right", Se3()}, {"antenna", Se3()}, {"base", Se3()}}};
  EXPECT_THAT(PatchUrdf(kRobot, "rig.urdf", wanted).error().what, HasSubstr("no joint of rig.urdf can take a pose"));
  wanted.poses.emplace("lidar", Se3());
  EXPECT_THAT(PatchUrdf(kRobot, "rig.urdf", wanted)->left_out,
              testing::ElementsAre("antenna: the file has no link of that name", HasSubstr("base: its link is the top"),
                                   HasSubstr("right:")));
  wanted = {"right", {{"lidar", Se3()}, {"mast", Se3()}}};
  EXPECT_THAT(PatchUrdf(kRobot, "rig.urdf", wanted).error().what, HasSubstr("a joint between it and right moves"));
}

// A real robot: its 3 cameras and a lidar are put 5 mm and 1 mrad from where they were, and read back.
TEST(UrdfPatch, ARealRobotIsPatchedAndReadBack) {
  const std::filesystem::path path = Recording("drift_grandtour/urdf/boxi_flat.urdf");
  if (!std::filesystem::exists(path))
    GTEST_SKIP() << "no recording drift_grandtour in ../shared/data beside the project";
  const std::string text = formats::samples::FileText(path.string());
  const auto file = ReadRigFile(text, "boxi_flat.urdf");
  ASSERT_TRUE(file) << file.error().what;
  const auto poses = PosesIn(*file, "box_base");
  ASSERT_TRUE(poses) << poses.error().what;
  Vector6d step;
  step << 0.003, 0.004, 0, 0.001, 0, 0;
  LinkPoses wanted{"box_base", {}};
  for (const FramePose& pose : file->poses)
    if (pose.parent == "box_base" && pose.frame != "prism")
      wanted.poses.emplace(pose.frame, poses->at(pose.frame) * Se3::Exp(step));
  const auto patched = PatchUrdf(text, "boxi_flat.urdf", wanted);
  ASSERT_TRUE(patched) << patched.error().what;
  EXPECT_EQ(patched->changes.size(), wanted.poses.size());
  const auto before = urdf::parseURDF(text), after = urdf::parseURDF(patched->text);
  ASSERT_TRUE(before && after);
  for (const auto& [name, link] : before->links_)
    for (const Eigen::Vector3d& p : exports::sample::Points()) {
      const Eigen::Vector3d was = OnTop(*before, name, p), is = OnTop(*after, name, p);
      EXPECT_EQ((is - was).norm() > 0.001, IsBelow(*before, name, wanted)) << name;
    }
  for (const auto& [name, pose] : wanted.poses)
    for (const Eigen::Vector3d& p : exports::sample::Points())
      EXPECT_LT((InRoot(*after, "box_base", OnTop(*after, name, p)) - pose * p).norm(), 1e-12) << name;
  for (const OriginChange& change : patched->changes) EXPECT_NEAR(change.turned_rad, 0.001, 1e-9) << change.joint;
}

}  // namespace
}  // namespace rigcal::rig_files
