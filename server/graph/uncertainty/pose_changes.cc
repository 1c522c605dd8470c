#include "server/graph/uncertainty/pose_changes.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "server/graph/uncertainty/joint_poses.h"
#include "server/math/tangent.h"

namespace rigcal::graph {
namespace {

const Se3* KnownIn(const JointPoses& poses, const SensorId& sensor) {
  const auto found = poses.T_ref_sensor.find(sensor);
  return found == poses.T_ref_sensor.end() ? nullptr : &found->second;
}

std::optional<double> WorstAxis(const Vector6d& e, const Matrix6d& covariance) {
  double worst = 0.0;
  for (int axis = 0; axis < 6; ++axis) {
    if (covariance(axis, axis) <= 0.0) return std::nullopt;
    worst = std::max(worst, std::abs(e(axis)) / std::sqrt(covariance(axis, axis)));
  }
  return worst;
}

// A pose that is as it was is no change, whatever its sigma is now.
std::optional<PoseChange> MoveOf(const JointPoses& before, const JointPoses& after, const SensorId& sensor) {
  const Se3& T_ref_after = *KnownIn(after, sensor);
  const Se3 T_ref_before = KnownIn(before, after.reference)->Inverse() * *KnownIn(before, sensor);
  const Vector6d e = (T_ref_before.Inverse() * T_ref_after).Log();
  if (e.isZero(1e-12)) return std::nullopt;
  PoseChange change{sensor, "moved", e.head<3>().norm(), e.tail<3>().norm(), {}};
  if (const auto relative = RelativeOf(before, after.reference, sensor))
    change.sigma_ratio = WorstAxis(e, relative->covariance);
  return change;
}

auto OrderOf(const PoseChange& change) {
  return std::make_tuple(change.how == "moved", -change.sigma_ratio.value_or(-1.0), -change.moved_m, change.sensor);
}

}  // namespace

std::vector<PoseChange> PoseChangesBetween(const JointPoses& before, const JointPoses& after) {
  std::set<SensorId> sensors;
  for (const JointPoses* poses : {&before, &after})
    for (const auto& [sensor, T_ref_sensor] : poses->T_ref_sensor) sensors.insert(sensor);
  sensors.erase(after.reference);
  const bool tied = KnownIn(before, after.reference) != nullptr;
  std::vector<PoseChange> changes;
  for (const SensorId& sensor : sensors) {
    const bool was = tied && KnownIn(before, sensor) != nullptr, is = KnownIn(after, sensor) != nullptr;
    if (was && is) {
      if (auto move = MoveOf(before, after, sensor)) changes.push_back(std::move(*move));
    } else {
      changes.push_back({sensor, is ? "gained" : "lost", 0.0, 0.0, {}});
    }
  }
  std::sort(changes.begin(), changes.end(),
            [](const PoseChange& a, const PoseChange& b) { return OrderOf(a) < OrderOf(b); });
  return changes;
}

}  // namespace rigcal::graph
