#include "server/fleet/as_found/one_visit_scatter.h"

#include <cmath>

namespace rigcal::fleet {
namespace {

using Eigen::Index;

// Shifts or turns: either may be told alone.
struct Half {
  ScatterOfAxes VisitScatter::*of_others;
  double ScatterDof::*dof;
  double PoseLimit::*assumed;
  Index first;  // of its three rows
};
constexpr Half kShifts = {&VisitScatter::translation, &ScatterDof::translation, &PoseLimit::m, tangent::kTranslation};
constexpr Half kTurns = {&VisitScatter::rotation, &ScatterDof::rotation, &PoseLimit::rad, tangent::kRotation};

// Of one visit: what other robots scatter by where they tell it, else the assumed, which is taken as known.
// `own`: the variance by which the visit errs.
ScatterTaken TakenOfOneVisit(const AsFoundInput& input, const SensorId& sensor, const Half& half, double own) {
  const auto pool = input.pooled_scatter.find(sensor);
  if (pool != input.pooled_scatter.end())
    if (const ScatterTaken taken = TakenScatter({0.0, own, 0.0}, pool->second.*half.of_others); taken.by_pool)
      return taken;
  return {std::pow(input.assumed_scatter.*half.assumed, 2)};
}

// Into what nothing tells yet; the scatter of the visit in use and that of the session are added to its `variance`. An
// axis of which nothing is known is left so: it is no better known for a scatter. Whether other robots tell it.
bool TakeScatter(const AsFoundInput& input, const Half& half, Eigen::Ref<Vector6d> variance, KnownPose& pose) {
  ScatterDof dof = pose.DofOfScatter();
  if (dof.*half.dof > 0) return true;  // the calibration in use was fused by it
  auto rows = variance.segment<3>(half.first);
  const ScatterTaken taken = TakenOfOneVisit(input, pose.sensor, half, rows.mean());
  const Eigen::Vector3d of_one = taken.variance * Eigen::Vector3d(taken.share.data()), of_both = 2 * of_one;
  rows += (rows.array() > 0).select(of_both, Eigen::Vector3d::Zero()).eval();
  pose.visit_variance.segment<3>(half.first) = of_one;
  if (!taken.by_pool) pose.assumed_variance.segment<3>(half.first) = of_both;
  dof.*half.dof = taken.dof;
  pose.scatter_dof = dof;
  return taken.by_pool;
}

void TakeScatter(const AsFoundInput& input, Eigen::Ref<Vector6d> variance, KnownPose& pose) {
  const bool shifts = TakeScatter(input, kShifts, variance, pose), turns = TakeScatter(input, kTurns, variance, pose);
  const auto pool = input.pooled_scatter.find(pose.sensor);
  if (shifts && turns && pose.scatter_robots == 0 && pool != input.pooled_scatter.end())
    pose.scatter_robots = pool->second.robots;
}

}  // namespace

KnownPoses WithScatter(KnownPoses in_use, const AsFoundInput& input) {
  Index row = 0;
  for (KnownPose& pose : in_use.poses) {
    if (pose.sensor == in_use.reference) continue;
    Vector6d variance = in_use.covariance.diagonal().segment<6>(row);
    if (pose.visits < 2) TakeScatter(input, variance, pose);
    in_use.covariance.diagonal().segment<6>(row) = variance;
    row += 6;
  }
  return in_use;
}

}  // namespace rigcal::fleet
