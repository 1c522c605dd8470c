// A rig whose visits are drawn: by turns about an axis and shifts, not by the Exp that the server uses.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <random>
#include <string>
#include <vector>

#include "server/fleet/as_found/as_found.h"

namespace rigcal::fleet {

inline const SensorId kLeft("left"), kRight("right"), kRear("rear"), kTop("top");

// T with a small step in the sensor's own axes. To first order that is T Exp(step).
inline Se3 Stepped(const Se3& T, const Vector6d& step) {
  Se3 stepped = T;
  stepped.p_m += T.q * Eigen::Vector3d(step.head<3>());
  const double angle_rad = step.tail<3>().norm();
  if (angle_rad > 0) stepped.q = T.q * Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, step.tail<3>() / angle_rad));
  return stepped;
}

inline Se3 PlacedAt(double x_m, double y_m, double z_m, const Eigen::Vector3d& axis, double angle_rad) {
  return {{x_m, y_m, z_m}, Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, axis.normalized()))};
}

inline Vector6d Along(int axis, double step) {
  Vector6d along = Vector6d::Zero();
  along(axis) = step;
  return along;
}

// The first is the reference.
inline KnownPoses DrawnRig() {
  KnownPoses rig;
  rig.reference = kLeft;
  rig.poses = {{kLeft, {}},
               {kRear, PlacedAt(-0.8, 0.1, 0.2, {0, 0, 1}, 2.4)},
               {kRight, PlacedAt(0.3, -0.4, 0.05, {1, 2, 0.5}, 0.7)},
               {kTop, PlacedAt(0.1, 0.6, 0.9, {0.2, -1, 1}, -1.3)}};
  return rig;
}

class Draws {
 public:
  explicit Draws(unsigned seed) : engine_(seed) {}
  Eigen::VectorXd Normal(Eigen::Index size) {
    return Eigen::VectorXd::NullaryExpr(size, [&] { return normal_(engine_); });
  }
  double ChiSquare(double dof) { return std::chi_squared_distribution<>(dof)(engine_); }
  Eigen::VectorXd Of(const Eigen::MatrixXd& C) { return C.llt().matrixL() * Normal(C.rows()); }
  // As estimated from so many draws.
  Eigen::MatrixXd Estimated(const Eigen::MatrixXd& C, int dof) {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(C.rows(), C.cols());
    for (int i = 0; i < dof; ++i) {
      const Eigen::VectorXd one = Of(C);
      sum += one * one.transpose();
    }
    return sum / dof;
  }

 private:
  std::mt19937 engine_;
  std::normal_distribution<double> normal_;
};

// Errors of sensors that hang together, as those of one session do.
inline Eigen::MatrixXd Correlated(double sigma_m, double sigma_rad, Eigen::Index sensors = 3) {
  Draws draws(99);
  Eigen::MatrixXd F(6 * sensors, 30);
  for (Eigen::Index row = 0; row < F.rows(); ++row) F.row(row) = draws.Normal(30).transpose();
  Eigen::VectorXd scale(6 * sensors);
  for (Eigen::Index row = 0; row < scale.size(); ++row) scale(row) = row % 6 < 3 ? sigma_m : sigma_rad;
  const Eigen::MatrixXd shape = F * F.transpose() / 30 + 0.5 * Eigen::MatrixXd::Ones(6 * sensors, 6 * sensors);
  return scale.asDiagonal() * shape * scale.asDiagonal();
}

// Every pose but the reference's stepped by its six rows.
inline KnownPoses WithErrors(KnownPoses rig, const Eigen::VectorXd& errors) {
  Eigen::Index row = 0;
  for (KnownPose& pose : rig.poses) {
    if (pose.sensor == rig.reference) continue;
    pose.T_ref_sensor = Stepped(pose.T_ref_sensor, errors.segment<6>(row));
    row += 6;
  }
  return rig;
}

// A sensor that was bumped, the reference too: then all others are elsewhere as seen from it.
inline KnownPoses Bumped(KnownPoses rig, const SensorId& sensor, const Vector6d& step) {
  const Se3 T_reference_moved = Stepped({}, step);
  for (KnownPose& pose : rig.poses)
    if (sensor == rig.reference)
      pose.T_ref_sensor = pose.sensor == sensor ? Se3{} : T_reference_moved.Inverse() * pose.T_ref_sensor;
    else if (pose.sensor == sensor)
      pose.T_ref_sensor = Stepped(pose.T_ref_sensor, step);
  return rig;
}

struct Errors {
  Eigen::MatrixXd in_use, session;  // of the mean of visits so far; of the session
  double visit_sigma_m = 0.0, visit_sigma_rad = 0.0;
  int dof = 0;             // of the session's; 0: known
  int visits = 1'000'000;  // that are in use, and tell what visits scatter by
};

// A scatter as so many visits of errors `c` tell it, three axes alike: none where it is less than their errors.
inline double ToldScatter(double sigma, double c, int visits, Draws& draws) {
  const double numbers = 3.0 * (visits - 1);
  if (visits < 2) return 0.0;
  return std::max(0.0, (sigma * sigma + c * c) * draws.ChiSquare(numbers) / numbers - c * c);
}

// `is`: where sensors sat on this visit, but for what visits scatter by.
inline AsFoundInput Visit(const KnownPoses& was, const KnownPoses& is, const Errors& errors, Draws& draws) {
  const Eigen::Index rows = errors.in_use.rows();
  Eigen::VectorXd scatter(rows), told(rows);
  AsFoundInput input;
  input.in_use.poses = was.poses;
  Eigen::Index row = 0;
  for (KnownPose& pose : input.in_use.poses) {
    if (pose.sensor == was.reference) continue;
    pose.visits = errors.visits;
    const double of_m = ToldScatter(errors.visit_sigma_m, std::sqrt(errors.session(row, row)), errors.visits, draws),
                 of_rad = ToldScatter(errors.visit_sigma_rad, std::sqrt(errors.session(row + 3, row + 3)),
                                      errors.visits, draws);
    pose.visit_variance << Eigen::Vector3d::Constant(of_m), Eigen::Vector3d::Constant(of_rad);
    told.segment<6>(row) = pose.visit_variance;
    scatter.segment<6>(row) << Eigen::Vector3d::Constant(errors.visit_sigma_m),
        Eigen::Vector3d::Constant(errors.visit_sigma_rad);
    row += 6;
  }
  const Eigen::VectorXd of_mean = scatter.cwiseProduct(draws.Normal(rows)) / std::sqrt(errors.visits);
  KnownPoses in_use = was;
  in_use.poses = input.in_use.poses;
  input.in_use = WithErrors(WithErrors(in_use, of_mean), draws.Of(errors.in_use));
  input.in_use.covariance = errors.in_use;
  input.in_use.covariance.diagonal() += told * (1 + 1.0 / errors.visits);
  input.session = WithErrors(WithErrors(is, scatter.cwiseProduct(draws.Normal(rows))), draws.Of(errors.session));
  input.session.covariance = errors.dof > 0 ? draws.Estimated(errors.session, errors.dof) : errors.session;
  for (KnownPose& pose : input.session.poses) pose.dof = errors.dof;
  input.left = input.session;
  return input;
}

inline Errors SomeErrors() { return {Correlated(1.5e-4, 1e-4), Correlated(3e-4, 2e-4), 1e-4, 1e-4, 0}; }

inline const SensorFound& Of(const SensorId& sensor, const AsFound& found) {
  for (const SensorFound& one : found.sensors)
    if (one.sensor == sensor) return one;
  throw std::out_of_range("no sensor " + sensor.str());
}

inline std::vector<SensorId> Drifted(const AsFound& found) {
  std::vector<SensorId> drifted;
  for (const SensorFound& sensor : found.sensors)
    if (sensor.state == FoundState::kDrifted) drifted.push_back(sensor.sensor);
  return drifted;
}

}  // namespace rigcal::fleet
