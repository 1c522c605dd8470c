#include "client/import/frame_tree.h"

#include <gtest/gtest.h>

namespace rigcal::importing {
namespace {

bags::StampedPose Link(std::int64_t stamp_ns, const std::string& parent, const std::string& child,
                       const Eigen::Vector3d& p_m, double yaw_rad = 0) {
  return {{stamp_ns, parent}, child, {p_m, Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()))}};
}

TEST(FrameTree, FollowsAChain) {
  FrameTree tree;
  tree.Add(Link(0, "/tool", "/camera", {1, 0, 0}), true);
  tree.Add(Link(100, "base", "arm", {0, 0, 2}, M_PI / 2), false);
  EXPECT_FALSE(tree.Pose("base", "camera", 5));  // arm -> tool did not come
  tree.Add(Link(103, "arm", "tool", {0, 0, 0}), false);
  const auto pose = tree.Pose("base", "/camera", 5);
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->header.stamp_ns, 103);
  EXPECT_TRUE(pose->T_frame_child.p_m.isApprox(Eigen::Vector3d(0, 1, 2), 1e-12)) << pose->T_frame_child.p_m.transpose();
  EXPECT_FALSE(tree.Pose("base", "camera", 2)) << "its parts are 3 ns apart";
  EXPECT_FALSE(tree.Pose("camera", "base", 5)) << "the other way round";
  EXPECT_FALSE(tree.Pose("tool", "camera", 5)) << "never moves";
}

TEST(FrameTree, ARingHasNoEnd) {
  FrameTree tree;
  tree.Add(Link(1, "a", "b", {1, 0, 0}), false);
  tree.Add(Link(1, "b", "a", {1, 0, 0}), false);
  EXPECT_FALSE(tree.Pose("c", "a", 5));
}

}  // namespace
}  // namespace rigcal::importing
