#include <algorithm>

#include "idl/convert.h"

namespace rigcal::wire {
namespace {

struct PartMemory {
  rigcal_wire_MeasuredPart part{};
  std::vector<rigcal_wire_OpenDirection> open;
  std::vector<rigcal_wire_MeasuredAxis> axes;
};

void FillPose(const Se3& T, const Matrix6d& C, double (&p_m)[3], double (&q_xyzw)[4], double (&covariance)[36]) {
  for (int i = 0; i < 3; ++i) p_m[i] = T.p_m[i];
  for (int i = 0; i < 4; ++i) q_xyzw[i] = T.q.coeffs()[i];
  for (int row = 0; row < 6; ++row)
    for (int col = 0; col < 6; ++col) covariance[6 * row + col] = C(row, col);
}

Result<rigcal_wire_MeasuredAxis> ToAxis(const AxisResult& axis) {
  rigcal_wire_MeasuredAxis sample{};
  RIGCAL_TRY(CopyText(axis.name, sample.name, sizeof sample.name, "axis"));
  sample.turn = axis.turn;
  std::copy_n(axis.direction.data(), 3, sample.direction);
  sample.measured = axis.measured();
  sample.position_m = axis.position_m.value_or(0.0);
  sample.sigma_m = axis.sigma_m.value_or(0.0);
  sample.sigma_rad = axis.sigma_rad.value_or(0.0);
  return sample;
}

Status FillPart(const SensorPose& pose, const std::optional<Eigen::Matrix3d>& R_ref_robot, PartMemory& memory) {
  FillPose(pose.measured_part->T_ref_sensor, pose.measured_part->covariance, memory.part.p_m, memory.part.q_xyzw,
           memory.part.covariance);
  for (const Vector6d& direction : pose.unobservable_basis)
    std::copy_n(direction.data(), 6, memory.open.emplace_back().d);
  for (const AxisResult& axis : AxesOf(pose, R_ref_robot)) {
    RIGCAL_ASSIGN(const rigcal_wire_MeasuredAxis sample, ToAxis(axis));
    memory.axes.push_back(sample);
  }
  const auto open_count = static_cast<std::uint32_t>(memory.open.size());
  const auto axis_count = static_cast<std::uint32_t>(memory.axes.size());
  memory.part.open_directions = {open_count, open_count, memory.open.data(), false};
  memory.part.axes = {axis_count, axis_count, memory.axes.data(), false};
  return {};
}

}  // namespace

Result<Owned<rigcal_wire_Calibration>> ToCalibration(const RobotId& robot, const RobotState::Calibration& calibration,
                                                     const SensorPose& pose) {
  const Revision& revision = calibration.revision;
  Owned<rigcal_wire_Calibration> owned;
  rigcal_wire_Calibration& sample = owned.sample;
  RIGCAL_TRY(CopyText(robot.str(), sample.robot_id, sizeof sample.robot_id, "robot_id"));
  RIGCAL_TRY(CopyText(pose.sensor.str(), sample.sensor_id, sizeof sample.sensor_id, "sensor_id"));
  RIGCAL_TRY(CopyText(calibration.reference.str(), sample.reference_id, sizeof sample.reference_id, "reference_id"));
  RIGCAL_TRY(CopyText(NameOf(revision.verdict.level), sample.verdict, sizeof sample.verdict, "verdict"));
  sample.revision = static_cast<std::uint32_t>(revision.number);
  sample.stamp_ns = revision.created_at.ns;
  sample.known = pose.known;
  FillPose(pose.known ? pose.T_ref_sensor : Se3{}, pose.known ? pose.covariance : Matrix6d(Matrix6d::Zero()),
           sample.p_m, sample.q_xyzw, sample.covariance);
  if (pose.known || !pose.measured_part) return owned;
  auto memory = std::make_shared<PartMemory>();
  RIGCAL_TRY(FillPart(pose, calibration.R_ref_robot, *memory));
  sample.measured_part = {1, 1, &memory->part, false};
  owned.memory = std::move(memory);
  return owned;
}

}  // namespace rigcal::wire
