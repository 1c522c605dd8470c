#include "server/calib/eye_to_hand/exchanged_roles.h"

#include <Eigen/LU>

#include "server/math/covariance.h"

namespace rigcal::calib {
namespace {

Eigen::Vector3d MeanPosition(const PoseTable& poses) {
  Eigen::Vector3d mean_m = Eigen::Vector3d::Zero();
  for (const TimedPose& pose : poses) mean_m += pose.T_world_body.p_m / static_cast<double>(poses.size());
  return mean_m;
}

}  // namespace

ExchangedRoles WithRolesExchanged(const HandEyeProblem& problem) {
  ExchangedRoles roles;
  roles.hand_eye = problem;
  roles.tracker_is_a = problem.a.sensor.kind == SensorKind::kTracker;
  HandEyeSide& flange = roles.tracker_is_a ? roles.hand_eye.a : roles.hand_eye.b;
  if (!flange.poses.empty()) roles.T_base_anchor.p_m = MeanPosition(flange.poses);
  for (TimedPose& pose : flange.poses)
    pose.T_world_body = (pose.T_world_body.Inverse() * roles.T_base_anchor).Normalized();
  if (problem.T_a_b_nominal)
    roles.hand_eye.T_a_b_nominal = roles.tracker_is_a ? roles.T_base_anchor.Inverse() * *problem.T_a_b_nominal
                                                      : *problem.T_a_b_nominal * roles.T_base_anchor;
  return roles;
}

Se3 EdgePose(const ExchangedRoles& roles, const Se3& T_a_b) {
  return (roles.tracker_is_a ? roles.T_base_anchor * T_a_b : T_a_b * roles.T_base_anchor.Inverse()).Normalized();
}

Se3 FlangeBoard(const ExchangedRoles& roles, const Se3& T_world_a_world_b) {
  return roles.tracker_is_a ? T_world_a_world_b : T_world_a_world_b.Inverse();
}

Uncertainty EdgeUncertainty(const ExchangedRoles& roles, Uncertainty uncertainty) {
  if (roles.tracker_is_a) return uncertainty;
  const Matrix6d M = Adjoint(roles.T_base_anchor), back = Adjoint(roles.T_base_anchor.Inverse());
  Uncertainty moved =
      FromInformation(Symmetrized(back.transpose() * uncertainty.Omega * back), uncertainty.source, uncertainty.dof);
  moved.blocks = std::move(uncertainty.blocks);
  for (BlockVector& block : moved.blocks) block.d = M * block.d;
  moved.contributions = std::move(uncertainty.contributions);
  for (Contribution& given : moved.contributions) {
    given.covariance = Symmetrized(M * given.covariance * M.transpose());
    for (Vector6d& shift : given.shifts) shift = M * shift;
  }
  return moved;
}

const HandEyeSide& CameraOf(const HandEyeProblem& problem) {
  return problem.a.sensor.kind == SensorKind::kCamera ? problem.a : problem.b;
}

const HandEyeSide& FlangeOf(const HandEyeProblem& problem) {
  return problem.a.sensor.kind == SensorKind::kCamera ? problem.b : problem.a;
}

}  // namespace rigcal::calib
