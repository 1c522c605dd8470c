#include "server/fleet/as_found/known_poses.h"

#include <algorithm>
#include <cmath>

namespace rigcal::fleet {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// First row of a sensor; -1: it is the reference, which has none.
Index FirstRow(const KnownPoses& poses, const SensorId& sensor) {
  if (sensor == poses.reference) return -1;
  Index row = 0;
  for (const KnownPose& pose : poses.poses) {
    if (pose.sensor == sensor) return row;
    row += pose.sensor == poses.reference ? 0 : 6;
  }
  return -1;
}

void Forget(Index row, MatrixXd& covariance) {
  covariance.row(row).setZero();
  covariance.col(row).setZero();
  covariance(row, row) = kNothingKnown;
}

MatrixXd WithoutHoles(const MatrixXd& covariance) {
  MatrixXd whole = covariance;
  for (Index row = 0; row < whole.rows(); ++row)
    if (!covariance.row(row).allFinite() || !(covariance(row, row) > 0)) Forget(row, whole);
  return whole;
}

double SmallerDof(double a, double b) { return a <= 0 ? b : b <= 0 ? a : std::min(a, b); }

// Copies the blocks of sensors that both have.
void Put(const JointCovariance& joint, KnownPoses& poses) {
  std::vector<Index> rows;
  for (const SensorId& sensor : joint.sensors)
    rows.push_back(poses.Find(sensor) == nullptr ? -1 : FirstRow(poses, sensor));
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t k = 0; k < rows.size(); ++k)
      if (rows[i] >= 0 && rows[k] >= 0)
        poses.covariance.block<6, 6>(rows[i], rows[k]) =
            joint.matrix.block<6, 6>(static_cast<Index>(6 * i), static_cast<Index>(6 * k));
}

bool HasAll(const JointCovariance& joint, const KnownPoses& poses) {
  return std::all_of(poses.poses.begin(), poses.poses.end(), [&](const KnownPose& pose) {
    return pose.sensor == poses.reference ||
           std::find(joint.sensors.begin(), joint.sensors.end(), pose.sensor) != joint.sensors.end();
  });
}

// Of what both scatter by: a turn of the frame shifts what is seen from it.
ScatterDof DofOfBoth(const ScatterDof& a, const ScatterDof& b) {
  const double least = SmallerDof(SmallerDof(a.translation, a.rotation), SmallerDof(b.translation, b.rotation));
  return {least, least};
}

// Per axis of a sensor, as seen from a frame with a variance of its own.
Vector6d OfBoth(const Vector6d& of_sensor, const Matrix6d& by_frame, const Vector6d& of_frame) {
  return of_sensor + (by_frame * of_frame.asDiagonal() * by_frame.transpose()).diagonal();
}

Vector6d VarianceOnVisits(const FusedPose& fused) {
  return fused.visit_variance.value_or(EachAxis(fused.visit_sigma_m, fused.visit_sigma_rad).cwiseAbs2());
}

// How many stand behind it where the pool was taken, not the robot's own visits alone.
void TakePooled(const FusedPose& fused, KnownPose& pose) {
  if (!fused.visit_variance)  // a document of before it was told
    pose.visit_variance = AlongAxes(TakenScatter(fused.scatter.translation, fused.pooled_scatter->translation),
                                    TakenScatter(fused.scatter.rotation, fused.pooled_scatter->rotation));
  const bool taken = fused.scatter_dof.translation > fused.scatter.translation.dof &&
                     fused.scatter_dof.rotation > fused.scatter.rotation.dof;
  pose.scatter_robots = taken ? fused.pooled_scatter->robots : 0;
}

}  // namespace

ScatterDof KnownPose::DofOfScatter() const {
  const double own = std::max(0, visits - 1);
  return scatter_dof.value_or(ScatterDof{own, own});
}

const KnownPose* KnownPoses::Find(const SensorId& sensor) const {
  const auto found =
      std::find_if(poses.begin(), poses.end(), [&](const KnownPose& pose) { return pose.sensor == sensor; });
  return found == poses.end() ? nullptr : &*found;
}

KnownPoses PosesOf(const SessionEstimate& estimate) {
  KnownPoses poses{estimate.reference, {}, estimate.covariance};
  for (const RefinedPose& pose : estimate.poses) poses.poses.push_back({pose.sensor, pose.T_ref_sensor, pose.dof, 1});
  return poses;
}

KnownPoses PosesOf(const GraphSolution& solution, const SensorId& reference,
                   const std::vector<JointCovariance>& joint) {
  KnownPoses poses{reference, {}, {}};
  std::vector<Matrix6d> own;
  for (const SensorPose& pose : solution.poses) {
    if (!pose.known) continue;
    const FusedPose fused = pose.fused.value_or(FusedPose());
    poses.poses.push_back({pose.sensor, pose.T_ref_sensor, pose.dof, fused.sessions, VarianceOnVisits(fused)});
    if (fused.sessions > 1 || fused.pooled_scatter) poses.poses.back().scatter_dof = fused.scatter_dof;
    if (fused.pooled_scatter) TakePooled(fused, poses.poses.back());
    if (pose.sensor != reference) own.push_back(pose.covariance);
  }
  poses.covariance = MatrixXd::Zero(static_cast<Index>(6 * own.size()), static_cast<Index>(6 * own.size()));
  for (std::size_t i = 0; i < own.size(); ++i)
    poses.covariance.block<6, 6>(static_cast<Index>(6 * i), static_cast<Index>(6 * i)) = own[i];
  const auto whole =
      std::find_if(joint.begin(), joint.end(), [&](const JointCovariance& one) { return HasAll(one, poses); });
  if (!solution.fused.sensors.empty())
    Put({solution.fused.sensors, solution.fused.covariance}, poses);
  else if (whole != joint.end())
    Put(*whole, poses);
  return poses;
}

void WalkOn(const GraphSolution& solution, double days, KnownPoses& poses) {
  for (const SensorPose& pose : solution.poses) {
    const Index row = poses.Find(pose.sensor) != nullptr ? FirstRow(poses, pose.sensor) : -1;
    if (!pose.fused || row < 0 || days <= 0) continue;
    poses.covariance.diagonal().segment<6>(row) +=
        days * EachAxis(pose.fused->walk_m_per_sqrt_day, pose.fused->walk_rad_per_sqrt_day).cwiseAbs2();
  }
}

KnownPoses Some(const KnownPoses& poses, const std::function<bool(const SensorId&)>& is_one) {
  KnownPoses some{poses.reference, {}, {}};
  std::vector<Index> rows;
  for (const KnownPose& pose : poses.poses) {
    if (!is_one(pose.sensor)) continue;
    some.poses.push_back(pose);
    const Index first = FirstRow(poses, pose.sensor);
    for (Index row = first; first >= 0 && row < first + 6; ++row) rows.push_back(row);
  }
  some.covariance = poses.covariance(rows, rows);
  return some;
}

PosesSeen SeenFrom(const SensorId& frame, const std::vector<SensorId>& sensors, const KnownPoses& poses) {
  const MatrixXd covariance = WithoutHoles(poses.covariance);
  const KnownPose& of_frame = *poses.Find(frame);
  const Index frame_row = FirstRow(poses, frame);
  MatrixXd J = MatrixXd::Zero(static_cast<Index>(6 * sensors.size()), covariance.rows());
  PosesSeen seen;
  seen.scatter.resize(J.rows());
  seen.assumed.resize(J.rows());
  for (const SensorId& sensor : sensors) {
    const auto row = static_cast<Index>(6 * seen.T_frame_sensor.size());
    const KnownPose& pose = *poses.Find(sensor);
    seen.T_frame_sensor.push_back(of_frame.T_ref_sensor.Inverse() * pose.T_ref_sensor);
    seen.dof.push_back(SmallerDof(of_frame.dof, pose.dof));
    const Matrix6d by_frame = -Adjoint(seen.T_frame_sensor.back().Inverse());
    if (const Index own = FirstRow(poses, sensor); own >= 0) J.block<6, 6>(row, own).setIdentity();
    if (frame_row >= 0) J.block<6, 6>(row, frame_row) = by_frame;
    seen.scatter.segment<6>(row) = ScatterSeenFrom(frame, sensor, poses);
    seen.assumed.segment<6>(row) = OfBoth(pose.assumed_variance, by_frame, of_frame.assumed_variance);
    seen.scatter_dof.push_back(sensor == poses.reference  ? DofOfBoth(of_frame.DofOfScatter(), {})
                               : frame == poses.reference ? pose.DofOfScatter()
                                                          : DofOfBoth(of_frame.DofOfScatter(), pose.DofOfScatter()));
  }
  seen.covariance = J * covariance * J.transpose();
  return seen;
}

Vector6d ScatterSeenFrom(const SensorId& frame, const SensorId& sensor, const KnownPoses& poses) {
  const KnownPose &of_frame = *poses.Find(frame), &pose = *poses.Find(sensor);
  const Matrix6d by_frame = Adjoint((of_frame.T_ref_sensor.Inverse() * pose.T_ref_sensor).Inverse());
  return OfBoth(pose.visit_variance, by_frame, of_frame.visit_variance);
}

std::optional<Se3> PlaceIn(const SensorId& frame, const SensorId& sensor, const KnownPoses& poses) {
  const KnownPose* of_frame = poses.Find(frame);
  const KnownPose* pose = poses.Find(sensor);
  if (of_frame == nullptr || pose == nullptr) return std::nullopt;
  return of_frame->T_ref_sensor.Inverse() * pose->T_ref_sensor;
}

}  // namespace rigcal::fleet
