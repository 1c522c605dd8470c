#include "server/pipeline/rig_models/pooled_scatter.h"

#include <set>

#include "server/fleet/population/scatter_pool.h"
#include "storage/fleet/visit_scatter.h"

namespace rigcal::pipeline {
namespace {

// More tell hardly more, and are to be read for each revision.
constexpr int kPooledRobotsMax = 200;

std::set<SensorId> MovedIn(const GraphSolution& solution) {
  std::set<SensorId> moved;
  for (const SensorMovedBetween& one : solution.fused.moved) moved.insert(one.sensor);
  return moved;
}

}  // namespace

Result<PooledScatter> LoadPooledScatter(storage::Store& store, const RobotId& robot, const std::string& rig_model,
                                        const SensorId& reference) {
  if (rig_model.empty() || reference.empty()) return PooledScatter();
  RIGCAL_ASSIGN(const auto others, storage::LoadScatterOfOthers(store, robot, rig_model, reference, kPooledRobotsMax));
  return fleet::PoolScatter(others);
}

Status KeepVisitScatter(storage::Store& store, const RobotId& robot, const std::string& rig_model,
                        const SensorId& reference, const GraphSolution& solution) {
  const std::set<SensorId> moved = MovedIn(solution);
  fleet::RobotScatter own;
  for (const SensorPose& pose : solution.poses)
    if (pose.fused && !moved.contains(reference) && !moved.contains(pose.sensor))
      own[pose.sensor] = pose.fused->scatter;
  return storage::ReplaceVisitScatter(store, robot, rig_model, reference, own);
}

PooledScatter PooledScatterOf(const GraphSolution& solution) {
  PooledScatter pooled;
  for (const SensorPose& pose : solution.poses)
    if (pose.fused && pose.fused->pooled_scatter) pooled[pose.sensor] = *pose.fused->pooled_scatter;
  return pooled;
}

}  // namespace rigcal::pipeline
