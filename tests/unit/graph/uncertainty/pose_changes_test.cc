// What a calibration would change: lengths by hand, sigmas by the covariance of before, and the order.
#include "server/graph/uncertainty/pose_changes.h"

#include <gmock/gmock.h>

namespace rigcal::graph {
namespace {

const SensorId kLeft("left"), kRear("rear"), kRight("right");

Se3 Turned(double x_m, double about_z_rad) {
  return {{x_m, 0.0, 0.0}, Eigen::Quaterniond(Eigen::AngleAxisd(about_z_rad, Eigen::Vector3d::UnitZ()))};
}

// Sigmas of 1 mm and 2 mrad, of all sensors but the reference.
JointPoses PosesOf(std::map<SensorId, Se3> poses) {
  JointPoses joint;
  joint.reference = kLeft;
  JointCovariance covariance;
  for (const auto& [sensor, pose] : poses)
    if (sensor != kLeft) covariance.sensors.push_back(sensor);
  const auto rows = static_cast<Eigen::Index>(6 * covariance.sensors.size());
  covariance.matrix = Eigen::MatrixXd::Zero(rows, rows);
  for (Eigen::Index row = 0; row < rows; ++row) covariance.matrix(row, row) = row % 6 < 3 ? 1e-6 : 4e-6;
  joint.T_ref_sensor = std::move(poses);
  joint.covariances = {covariance};
  return joint;
}

std::vector<SensorId> Names(const std::vector<PoseChange>& changes) {
  std::vector<SensorId> names;
  for (const PoseChange& change : changes) names.push_back(change.sensor);
  return names;
}

TEST(PoseChanges, AreInTheFrameOfTheSensorAndInItsSigmas) {
  const JointPoses before = PosesOf({{kLeft, {}}, {kRear, Turned(1.0, 0.5)}, {kRight, Turned(2.0, 0.0)}});
  const JointPoses after = PosesOf({{kLeft, {}}, {kRear, Turned(1.0, 0.506)}, {kRight, Turned(2.004, 0.0)}});
  const auto changes = PoseChangesBetween(before, after);
  ASSERT_THAT(Names(changes), testing::ElementsAre(kRight, kRear)) << "4 sigmas before 3";
  EXPECT_NEAR(changes[0].moved_m, 0.004, 1e-12);
  EXPECT_NEAR(changes[0].turned_rad, 0.0, 1e-12);
  EXPECT_NEAR(changes[0].sigma_ratio.value(), 4.0, 1e-9);
  EXPECT_NEAR(changes[1].moved_m, 0.0, 1e-12);
  EXPECT_NEAR(changes[1].turned_rad, 0.006, 1e-12);
  EXPECT_NEAR(changes[1].sigma_ratio.value(), 3.0, 1e-9);
}

TEST(PoseChanges, OfTheSamePosesThereAreNone) {
  const JointPoses poses = PosesOf({{kLeft, {}}, {kRight, Turned(2.0, 0.3)}});
  EXPECT_TRUE(PoseChangesBetween(poses, poses).empty());
}

TEST(PoseChanges, WhatOnlyOneKnowsComesFirst) {
  const JointPoses before = PosesOf({{kLeft, {}}, {kRear, Turned(1.0, 0.0)}, {kRight, Turned(2.0, 0.0)}});
  const JointPoses after = PosesOf({{kLeft, {}}, {kRight, Turned(2.1, 0.0)}});
  const auto changes = PoseChangesBetween(before, after);
  ASSERT_THAT(Names(changes), testing::ElementsAre(kRear, kRight));
  EXPECT_EQ(changes[0].how, "lost");
  EXPECT_FALSE(changes[0].sigma_ratio);
  EXPECT_EQ(PoseChangesBetween(after, before)[0].how, "gained");
}

// The rear sensor is the reference of the later one: what the earlier one says of the right one is taken from there.
TEST(PoseChanges, AreLaidTogetherAtTheLaterReference) {
  const Se3 T_left_rear = Turned(1.0, 0.5), T_left_right = Turned(2.0, 0.2);
  const JointPoses before = PosesOf({{kLeft, {}}, {kRear, T_left_rear}, {kRight, T_left_right}});
  JointPoses after = PosesOf({{kRear, {}}, {kRight, T_left_rear.Inverse() * T_left_right}});
  after.reference = kRear;
  const auto changes = PoseChangesBetween(before, after);
  ASSERT_THAT(Names(changes), testing::ElementsAre(kLeft)) << "it is lost, and nothing else changed";
  EXPECT_EQ(changes[0].how, "lost");
}

TEST(PoseChanges, WithoutACovarianceThereAreNoSigmas) {
  JointPoses before = PosesOf({{kLeft, {}}, {kRight, Turned(2.0, 0.0)}});
  before.covariances.clear();
  const auto changes = PoseChangesBetween(before, PosesOf({{kLeft, {}}, {kRight, Turned(2.004, 0.0)}}));
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_NEAR(changes[0].moved_m, 0.004, 1e-12);
  EXPECT_FALSE(changes[0].sigma_ratio);
}

}  // namespace
}  // namespace rigcal::graph
