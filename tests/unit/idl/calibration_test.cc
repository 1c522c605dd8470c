// What a robot is told of one of its sensors.
#include <gtest/gtest.h>

#include "idl/convert.h"

namespace rigcal::wire {
namespace {

RobotState::Calibration SampleCalibration() {
  RobotState::Calibration calibration;
  calibration.revision.number = 3;
  calibration.revision.created_at = Stamp{7};
  calibration.revision.verdict.level = VerdictLevel::kWarn;
  calibration.reference = SensorId("left");
  calibration.R_ref_robot = (Eigen::Matrix3d() << 0, -1, 0, 0, 0, -1, 1, 0, 0).finished();  // it looks along its z
  return calibration;
}

SensorPose SamplePose() {
  SensorPose pose;
  pose.sensor = SensorId("lidar");
  pose.known = true;
  pose.T_ref_sensor.p_m = {1, 2, 3};
  pose.covariance(4, 2) = 7;
  return pose;
}

TEST(CalibrationConversion, AWholePoseHasNoPart) {
  const auto owned = ToCalibration(RobotId("r"), SampleCalibration(), SamplePose());
  ASSERT_TRUE(owned);
  const rigcal_wire_Calibration& sample = owned->sample;
  EXPECT_STREQ(sample.robot_id, "r");
  EXPECT_STREQ(sample.sensor_id, "lidar");
  EXPECT_STREQ(sample.reference_id, "left");
  EXPECT_STREQ(sample.verdict, "warn");
  EXPECT_EQ(sample.revision, 3u);
  EXPECT_EQ(sample.stamp_ns, 7);
  EXPECT_TRUE(sample.known);
  EXPECT_EQ(sample.p_m[2], 3.0);
  EXPECT_EQ(sample.covariance[6 * 4 + 2], 7.0);
  EXPECT_EQ(sample.measured_part._length, 0u);
}

TEST(CalibrationConversion, APoseThatIsNotKnownHasNoNumbers) {
  SensorPose pose = SamplePose();
  pose.known = false;
  const auto owned = ToCalibration(RobotId("r"), SampleCalibration(), pose);
  ASSERT_TRUE(owned);
  EXPECT_FALSE(owned->sample.known);
  EXPECT_EQ(owned->sample.p_m[2], 0.0);
  EXPECT_EQ(owned->sample.q_xyzw[3], 1.0);
  EXPECT_EQ(owned->sample.covariance[6 * 4 + 2], 0.0);
  EXPECT_EQ(owned->sample.measured_part._length, 0u);
}

// The error is put on one axis of the sensor and looked for at the robot's, on the wire.
TEST(CalibrationConversion, APoseInPartHasEachAxisWithItsSigmaOrOpen) {
  SensorPose pose = SamplePose();
  pose.known = false;
  pose.unobservable_basis = {Vector6d::Unit(tangent::kY)};
  pose.measured_part = MeasuredPart{};
  pose.measured_part->T_ref_sensor.p_m = {0.25, -0.5, 1.5};
  pose.measured_part->covariance(tangent::kX, tangent::kX) = 9e-6;
  pose.measured_part->covariance(tangent::kRz, tangent::kRz) = 16e-6;
  const auto owned = ToCalibration(RobotId("r"), SampleCalibration(), pose);
  ASSERT_TRUE(owned);
  EXPECT_FALSE(owned->sample.known);
  EXPECT_EQ(owned->sample.p_m[2], 0.0);
  ASSERT_EQ(owned->sample.measured_part._length, 1u);
  const rigcal_wire_MeasuredPart& part = owned->sample.measured_part._buffer[0];
  EXPECT_EQ(part.p_m[2], 1.5);
  EXPECT_EQ(part.q_xyzw[3], 1.0);
  EXPECT_EQ(part.covariance[0], 9e-6);
  ASSERT_EQ(part.open_directions._length, 1u);
  EXPECT_EQ(part.open_directions._buffer[0].d[1], 1.0);
  ASSERT_EQ(part.axes._length, 6u);
  const rigcal_wire_MeasuredAxis *forward = part.axes._buffer, *sideways = forward + 1, *height = forward + 2,
                                 *roll = forward + 3;
  EXPECT_STREQ(forward->name, "forward");
  EXPECT_TRUE(forward->measured && !forward->turn);
  EXPECT_NEAR(forward->position_m, 1.5, 1e-12);
  EXPECT_NEAR(sideways->sigma_m, 3e-3, 1e-12);
  EXPECT_NEAR(sideways->position_m, -0.25, 1e-12);
  EXPECT_NEAR(sideways->direction[0], -1.0, 1e-12);
  EXPECT_STREQ(height->name, "height");
  EXPECT_FALSE(height->measured);
  EXPECT_EQ(height->position_m, 0.0);
  EXPECT_STREQ(roll->name, "roll");
  EXPECT_TRUE(roll->turn);
  EXPECT_NEAR(roll->sigma_rad, 4e-3, 1e-12);
}

}  // namespace
}  // namespace rigcal::wire
