#include "server/pipeline/rig_models/population.h"

#include <algorithm>
#include <map>
#include <set>

#include "server/fleet/population/population.h"
#include "server/fleet/population/scatter_pool.h"
#include "server/formats/rig_models/rig_model_answers.h"
#include "server/graph/uncertainty/joint_poses.h"
#include "server/pipeline/rig_models/rig_models.h"
#include "server/pipeline/robots/validity.h"
#include "storage/fleet/visit_scatter.h"
#include "storage/revisions/revision_poses.h"
#include "storage/settings/rig_models.h"

namespace rigcal::pipeline {
namespace {

constexpr int kPopulationRobotsMax = 10'000;

struct Loaded {
  std::map<RobotId, JointPoses> poses;
  std::vector<std::pair<RobotId, std::string>> left_out;
};

// Nothing: why not.
Status TakePosesInUse(storage::Store& store, const RobotId& robot, Loaded& loaded) {
  RIGCAL_ASSIGN(const auto in_use, LoadUsable(store, robot));
  if (!in_use) {
    loaded.left_out.emplace_back(robot, "no calibration of it is in use");
    return {};
  }
  RIGCAL_ASSIGN(auto poses, storage::LoadRevisionPoses(store, {robot, in_use->number}));
  if (poses)
    loaded.poses.emplace(robot, std::move(*poses));
  else
    loaded.left_out.emplace_back(robot, "the calibration in use has no poses that can be compared");
  return {};
}

// What is beyond the bound is told.
void CutToBound(std::vector<RobotId>& robots, Loaded& loaded) {
  if (robots.size() <= static_cast<std::size_t>(kPopulationRobotsMax)) return;
  loaded.left_out.emplace_back(robots.back(), "this and those after it by name are beyond the first " +
                                                  std::to_string(kPopulationRobotsMax) + " robots of the model");
  robots.pop_back();
}

SensorId MostUsedReference(const std::map<RobotId, JointPoses>& all) {
  std::map<SensorId, int> counts;
  for (const auto& [robot, poses] : all) ++counts[poses.reference];
  const auto most =
      std::max_element(counts.begin(), counts.end(), [](const auto& x, const auto& y) { return x.second < y.second; });
  return most == counts.end() ? SensorId() : most->first;
}

// Sensors that the revision knows against the reference, with how well.
fleet::RobotPlaces PlacesOn(const RobotId& robot, const JointPoses& poses, const SensorId& reference) {
  fleet::RobotPlaces places;
  places.robot = robot;
  for (const auto& [sensor, T] : poses.T_ref_sensor) {
    if (sensor == reference) continue;
    const auto relative = graph::RelativeOf(poses, reference, sensor);
    if (relative && relative->unobservable_basis.empty())
      places.places.emplace(sensor, fleet::SensorPlace{relative->T_A_B, relative->covariance});
  }
  return places;
}

// More tell hardly more, and are to be read for each revision.
constexpr int kPooledRobotsMax = 200;

std::set<SensorId> MovedIn(const GraphSolution& solution) {
  std::set<SensorId> moved;
  for (const SensorMovedBetween& one : solution.fused.moved) moved.insert(one.sensor);
  return moved;
}

}  // namespace

Result<Population> LoadPopulation(storage::Store& store, const std::string& rig_model) {
  ExpectedRig expected;
  Loaded loaded;
  RIGCAL_TRY(store.Read([&]() -> Status {
    RIGCAL_TRY(CheckRigModelKnown(store, rig_model, kListRigModels));
    RIGCAL_ASSIGN(expected, LoadExpectedRig(store, rig_model));
    RIGCAL_ASSIGN(auto robots, storage::LoadRobotsOfModel(store, rig_model, kPopulationRobotsMax + 1));
    CutToBound(robots, loaded);
    for (const RobotId& robot : robots) RIGCAL_TRY(TakePosesInUse(store, robot, loaded));
    return {};
  }));
  expected.model.name = rig_model;
  const SensorId reference =
      expected.model.reference.empty() ? MostUsedReference(loaded.poses) : expected.model.reference;
  std::vector<fleet::RobotPlaces> robots;
  for (const auto& [robot, poses] : loaded.poses) {
    if (poses.T_ref_sensor.contains(reference))
      robots.push_back(PlacesOn(robot, poses, reference));
    else
      loaded.left_out.emplace_back(robot, "its pose of " + reference.str() + " is not known");
  }
  Population population = fleet::DescribePopulation(expected.model, reference, std::move(robots));
  population.version = expected.version;
  population.left_out = std::move(loaded.left_out);
  std::sort(population.left_out.begin(), population.left_out.end());
  return population;
}

Result<std::string> TellPopulation(storage::Store& store, const formats::Parameters& parameters) {
  RIGCAL_ASSIGN(const std::string model, RequiredRigModel(parameters));
  RIGCAL_ASSIGN(const Population population, LoadPopulation(store, model));
  return formats::WritePopulation(population);
}

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
