// A pose of which some directions were not measured: what is known of it, axis by axis, and what is not, in words.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/math/se3.h"

namespace rigcal {

// The directions that are open stand beside it (SensorPose::unobservable_basis). Along these the pose holds what the
// drawing said, or the start: nobody measured that.
struct MeasuredPart {
  Se3 T_ref_sensor;
  Matrix6d covariance = Matrix6d::Zero();  // right tangent at the sensor; nothing along what is open
  bool by_jackknife = false;               // else analytic
};

// One of three shifts or three turns, each at right angles to the others of its kind.
struct AxisResult {
  // "forward", "sideways", "height", "roll", "pitch", "yaw" of the robot; where its axes are not known "x", "y", "z",
  // "rx", "ry", "rz" of the frame; empty: no axis within 10 deg.
  std::string name;
  bool turn = false;  // about `direction`, else along it
  Eigen::Vector3d direction =
      Eigen::Vector3d::Zero();               // unit, in the frame of the pose; rather forward, left and up than back
  std::optional<double> position_m;          // of the sensor along it; of a shift that was measured
  std::optional<double> sigma_m, sigma_rad;  // 1 sigma of a shift, of a turn; neither: not measured
  [[nodiscard]] bool measured() const { return sigma_m || sigma_rad; }  // as a shift or as a turn
};

// Shifts, then turns, of the pose T_frame_sensor, whose covariance has nothing along what is `open` (right tangents at
// the sensor, m and rad). What is open is split from the rest, each as near to the robot's axes as it goes: a shift
// that is open together with a turn makes both open. `R_frame_robot`: forward, left and up of the robot in the frame;
// without it the axes of the frame take their place.
[[nodiscard]] std::vector<AxisResult> AxesOf(const Se3& T_frame_sensor, const Matrix6d& covariance,
                                             const std::vector<Vector6d>& open,
                                             const std::optional<Eigen::Matrix3d>& R_frame_robot);

// What was not measured: "height"; "forward" and "yaw"; where an axis has no name "one direction" or "2 directions", as
// many as are open.
[[nodiscard]] std::vector<std::string> NamesOfOpen(const std::vector<AxisResult>& axes, std::size_t open_count);
// Whether each of them is an axis.
[[nodiscard]] bool OpenHaveNames(const std::vector<AxisResult>& axes);
// "the height", "the forward position", "the position along z", "the turn about z", "one direction": such a name in a
// sentence.
[[nodiscard]] std::string InSentence(const std::string& name);
// "0.90 forward, -0.44 sideways", or without the robot's axes "0.90 x, -0.44 y"; for tables.
[[nodiscard]] std::string DirectionText(const Eigen::Vector3d& direction,
                                        const std::optional<Eigen::Matrix3d>& R_frame_robot);
// The name, else the direction.
[[nodiscard]] std::string LabelOf(const AxisResult& axis, const std::optional<Eigen::Matrix3d>& R_frame_robot);

// The least certain of what was measured; nothing where no shift (turn) was.
struct RestSigma {
  std::optional<double> m, rad;
};
// The largest sigma among shifts, and among turns.
[[nodiscard]] RestSigma WorstSigmaOf(const std::vector<AxisResult>& axes);
// Whether all three turns were measured: then the rotation is known whole.
[[nodiscard]] bool TurnsMeasured(const std::vector<AxisResult>& axes);

}  // namespace rigcal
