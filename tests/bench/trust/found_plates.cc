#include "tests/bench/trust/found_plates.h"

#include <algorithm>

#include "client/sim/rig/random.h"
#include "server/base/process/parallel_for.h"
#include "server/detect/clouds/cloud_board.h"

namespace rigcal {
namespace {

Cloud WholeScan(const sim::Experiment& experiment, const SensorId& lidar, std::size_t capture_idx) {
  Cloud cloud;
  for (const sim::ScanPoint& point :
       sim::Scan(sim::SceneAt(experiment, capture_idx), experiment.rig.SensorOf(lidar).lidar,
                 experiment.T_world_sensor(lidar, capture_idx), experiment.beam_bias_m.at(lidar),
                 sim::KeyOf(experiment.options.seed, "scan", lidar.str(), capture_idx)))
    cloud.points_m.push_back(point.p_lidar.cast<float>());
  return cloud;
}

const Target& DeclaredBoard(const FeatureSession& session, const TargetId& id) {
  return *std::find_if(session.header.targets.begin(), session.header.targets.end(),
                       [&](const Target& target) { return target.id == id; });
}

struct SearchedScan {
  SensorId lidar;
  std::size_t capture_idx;
  std::map<TargetId, CloudView>* views;
};

}  // namespace

void FindPlates(FeatureSession& session) {
  const sim::Experiment& experiment = session.experiment;
  std::vector<SearchedScan> scans;
  for (auto& [lidar, clouds] : session.seen.clouds)
    for (std::size_t k = 0; k < experiment.captures.size(); ++k)
      if (const auto views = clouds.find(experiment.captures[k]); views != clouds.end())
        scans.push_back({lidar, k, &views->second});
  ParallelFor(scans.size(), [&](std::size_t i) {
    const Cloud cloud = WholeScan(experiment, scans[i].lidar, scans[i].capture_idx);
    for (auto& [board, view] : *scans[i].views) view = detect::DetectPlate(cloud, DeclaredBoard(session, board)).view;
  });
}

}  // namespace rigcal
