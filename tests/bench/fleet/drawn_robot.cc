#include "tests/bench/fleet/drawn_robot.h"

#include <cmath>

namespace rigcal::drawn_fleet {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

Isometry3d PlacedAt(double x_m, double y_m, double z_m, const Vector3d& axis, double angle_rad) {
  return Eigen::Translation3d(x_m, y_m, z_m) * Eigen::AngleAxisd(angle_rad, axis.normalized());
}

// Of a sensor's axes against those of the reference.
Matrix3d TurnOf(const Places& places, std::size_t sensor) {
  return places[kReference].rotation().transpose() * places[sensor].rotation();
}

Eigen::Index RowOf(std::size_t sensor) {
  return 6 * static_cast<Eigen::Index>(sensor < kReference ? sensor : sensor - 1);
}

// Of Draws::Visit: half shared, half each sensor's own.
Eigen::MatrixXd CovarianceOf(const Places& places, const Sizes& sizes) {
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(6 * (kSensors - 1), 6 * (kSensors - 1));
  for (std::size_t s = 0; s < kSensors; ++s)
    for (std::size_t t = 0; t < kSensors; ++t) {
      if (s == kReference || t == kReference) continue;
      Matrix3d shape = 0.5 * TurnOf(places, s).transpose() * TurnOf(places, t);
      if (s == t) shape += 0.5 * Matrix3d::Identity();
      C.block<3, 3>(RowOf(s), RowOf(t)) = sizes.session_m * sizes.session_m * shape;
      C.block<3, 3>(RowOf(s) + 3, RowOf(t) + 3) = sizes.session_rad * sizes.session_rad * shape;
    }
  return C;
}

}  // namespace

const std::array<SensorId, kSensors>& Names() {
  static const std::array<SensorId, kSensors> names = {SensorId("front"), SensorId("left"), SensorId("rear"),
                                                       SensorId("right"), SensorId("top")};
  return names;
}

Places Mounted() {
  return {PlacedAt(0.5, 0.1, 0.3, {0.3, 1, 0.2}, 1.1), PlacedAt(0.1, 0.4, 0.2, {1, 0.4, -0.6}, 0.9),
          PlacedAt(-0.6, 0.0, 0.25, {0, 0.2, 1}, 2.8), PlacedAt(0.1, -0.45, 0.2, {1, -1, 0.5}, -1.6),
          PlacedAt(0.0, 0.05, 0.8, {0.2, 0.1, 1}, -0.5)};
}

Isometry3d Stepped(const Isometry3d& T, const Vector6d& step) {
  const Vector3d turn = step.tail<3>();
  const double angle_rad = turn.norm();
  const Vector3d axis = angle_rad > 0 ? Vector3d(turn / angle_rad) : Vector3d::UnitX();
  return T * Eigen::Translation3d(step.head<3>()) * Eigen::AngleAxisd(angle_rad, axis);
}

Draws::Draws(unsigned seed, unsigned robot) {
  std::seed_seq sequence{seed, robot};
  engine_.seed(sequence);
}

Vector3d Draws::Scatter(std::size_t sensor, bool along_one_axis) {
  const Vector3d normal = Normal3();
  if (!along_one_axis) return normal;
  return std::sqrt(3.0) * normal.x() * (sensor % 2 == 0 ? Vector3d::UnitX() : Vector3d(Vector3d::Ones().normalized()));
}

VisitDraw Draws::Visit(const Places& places, const Sizes& sizes) {
  VisitDraw draw;
  const double half = std::sqrt(0.5);
  const Vector3d shift = half * Normal3(), turn = half * Normal3();
  for (std::size_t s = 0; s < kSensors; ++s) {
    draw.scatter[s] << sizes.scatter_m * Scatter(s, sizes.along_one_axis),
        sizes.scatter_rad * Scatter(s, sizes.along_one_axis);
    const Matrix3d back = TurnOf(places, s).transpose();
    draw.errors[s] << sizes.session_m * (back * shift + half * Normal3()),
        sizes.session_rad * (back * turn + half * Normal3());
  }
  if (!sizes.reference_scatters) draw.scatter[kReference].setZero();
  draw.errors[kReference].setZero();
  draw.told_ratio = std::chi_squared_distribution<>(sizes.session_dof)(engine_) / sizes.session_dof;
  return draw;
}

SessionEstimate EstimateOf(const Places& places, const VisitDraw& draw, const Sizes& sizes, SessionId session) {
  SessionEstimate estimate;
  estimate.session = std::move(session);
  estimate.reference = Names()[kReference];
  const Isometry3d reference = Stepped(places[kReference], draw.scatter[kReference]);
  for (std::size_t s = 0; s < kSensors; ++s) {
    const Isometry3d T = Stepped(reference.inverse() * Stepped(places[s], draw.scatter[s]), draw.errors[s]);
    estimate.poses.push_back({Names()[s], Se3{T.translation(), Eigen::Quaterniond(T.rotation())}.Normalized(),
                              static_cast<double>(sizes.session_dof)});
  }
  estimate.poses[kReference].T_ref_sensor = {};
  estimate.covariance = draw.told_ratio * CovarianceOf(places, sizes);
  return estimate;
}

}  // namespace rigcal::drawn_fleet
