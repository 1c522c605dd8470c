#include "server/fleet/causes/placed_sensors.h"

#include <algorithm>
#include <cmath>

namespace rigcal::fleet {
namespace {

constexpr double kPlaceMaxSigmas = 5.0;

std::optional<Placed> PlacedOf(const SensorPose& pose, const SensorId& reference,
                               const std::vector<const SessionHeader*>& newest) {
  for (const SessionHeader* header : newest) {
    const Sensor *from = SensorOf(*header, reference), *sensor = SensorOf(*header, pose.sensor);
    const auto drawn = from && sensor ? NominalPose(*header, *from, *sensor) : std::nullopt;
    if (!drawn) continue;
    const double variance_m2 = pose.covariance.diagonal().head<3>().maxCoeff();
    return Placed{pose.sensor, sensor->kind, pose.T_ref_sensor, *drawn, std::sqrt(std::max(variance_m2, 0.0))};
  }
  return std::nullopt;
}

}  // namespace

Vector6d Away(const Se3& drawn, const Se3& measured) {
  Vector6d away;
  away << measured.p_m - drawn.p_m, (drawn.Inverse() * measured).Log().tail<3>();
  return away;
}

double TimesTooFar(const Placed& placed, const Se3& place, const PlaceLimit& limit) {
  const Vector6d away = Away(place, placed.measured);
  return std::max(away.head<3>().norm() / std::max(limit.place_m, kPlaceMaxSigmas * placed.sigma_m),
                  away.tail<3>().norm() / limit.turn_rad);
}

bool IsFar(const Placed& placed, const PlaceLimit& limit) { return TimesTooFar(placed, placed.drawn, limit) > 1; }

std::vector<Placed> PlacedSensors(const GraphSolution& solution, const SessionHeaders& headers,
                                  const SensorId& reference) {
  const std::vector<const SessionHeader*> newest = NewestFirst(headers);
  std::vector<Placed> placed;
  for (const SensorPose& pose : solution.poses)
    if (pose.known)
      if (const auto one = PlacedOf(pose, reference, newest)) placed.push_back(*one);
  return placed;
}

std::vector<EdgeId> TakeMatchedFromDrawing(CauseSearch& search, const std::set<SensorId>& misplaced) {
  return IdsOf(search.Take([&](const Edge& edge) {
    return FailedFor(edge, {"low_overlap", "poor_fit", "starts_disagree", "ambiguous_pose", "not_converged"}) &&
           edge.method == "lidar_lidar" && (misplaced.contains(edge.frame_a) || misplaced.contains(edge.frame_b));
  }));
}

std::set<SensorId> MisplacedBy(const std::vector<RootCause>& causes) {
  std::set<SensorId> misplaced;
  for (const RootCause& cause : causes)
    if (cause.kind == CauseKind::kExchanged || cause.kind == CauseKind::kFarFromNominal ||
        cause.kind == CauseKind::kNominalUnit)
      misplaced.insert(cause.sensors.begin(), cause.sensors.end());
  return misplaced;
}

}  // namespace rigcal::fleet
