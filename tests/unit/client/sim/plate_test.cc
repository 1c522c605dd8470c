// Clouds against the product's own search for plates.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "client/sim/rig/random.h"
#include "client/sim/visit/observe.h"
#include "server/base/process/parallel_for.h"
#include "server/detect/clouds/cloud_board.h"
#include "server/formats/clouds/cloud.h"
#include "tests/unit/client/sim/sample.h"

namespace rigcal::sim {
namespace {

// Whether one of the candidates is the plate.
bool IsAmong(const CloudView& view, const Se3& T_lidar_plate) {
  for (const PlanePatch& patch : view.candidates)
    if ((patch.centre_m - T_lidar_plate.p_m).norm() < 0.10 &&
        patch.normal.dot(-T_lidar_plate.R().col(2)) > std::cos(3 * M_PI / 180))
      return true;
  return false;
}

TEST(SimPlate, PlatesAreFoundInTheMarsMappersClouds) {
  Options options;
  options.captures = 6;
  const Experiment experiment = Prepared(MarsMapper(), options);
  const Scene scene = SceneOf(experiment.rig);
  for (const char* name : {"lidar_horizontal", "lidar_vertical"}) {
    const RigSensor& lidar = experiment.rig.SensorOf(SensorId(name));
    std::map<TargetId, std::vector<int>> outcomes;  // per capture: 2 found, 1 missed, 0 not in view
    const std::vector<TargetId> boards = BoardsOf(experiment, lidar.id);
    for (const TargetId& board : boards) outcomes[board].resize(experiment.captures.size());
    ParallelFor(experiment.captures.size(), [&](std::size_t k) {
      const Se3 T_world_lidar = experiment.T_world_sensor(lidar.id, k);
      const std::string pcd = PcdOf(Scan(scene, lidar.lidar, T_world_lidar, {}, KeyOf(1, "scan", name, k)));
      const auto cloud = formats::ReadCloud(std::as_bytes(std::span(pcd)), "pcd", "cloud");
      for (const TargetId& id : boards) {
        const RigBoard& board = experiment.rig.BoardOf(id);
        const bool in_view = PlatePoints(experiment, scene, lidar, id, k).size() > 400;
        const auto view = detect::DetectPlate(*cloud, board.target).view;
        outcomes.at(id)[k] = !in_view ? 0 : IsAmong(view, T_world_lidar.Inverse() * board.T_world_plate) ? 2 : 1;
      }
    });
    for (const auto& [board, found] : outcomes) {
      const auto hits = std::count(found.begin(), found.end(), 2), misses = std::count(found.begin(), found.end(), 1);
      std::cout << name << " " << board.str() << ": " << hits << " found, " << misses << " missed\n";
      EXPECT_GE(hits, 4) << name << " " << board.str();
    }
  }
}

}  // namespace
}  // namespace rigcal::sim
