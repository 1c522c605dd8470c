// An experiment without pictures: what a perfect search would find in them, as values, with noise. For statistics over
// hundreds of seeds.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "client/sim/views/scan.h"
#include "client/sim/visit/experiment.h"
#include "client/sim/visit/session_text.h"
#include "server/model/sensors/features.h"

namespace rigcal::sim {

// Which boards a lidar's points count of: those of the cameras that it is calibrated with; all that it may see if it is
// calibrated with a tracker.
[[nodiscard]] std::vector<TargetId> BoardsOf(const Experiment& experiment, const SensorId& lidar);

// Every inner corner without noise, in the order of TargetPoints(), where the lens and the board as they are put it;
// nothing where the board is not seen whole: cut by the picture's border, hidden, from behind or at more than 75
// degrees. `scene`: that of the capture.
[[nodiscard]] std::optional<std::vector<Eigen::Vector2d>> TrueCorners(const Experiment& experiment, const Scene& scene,
                                                                      const RigSensor& camera, std::size_t capture_idx);
// The same with noise of corner_sigma_px on each coordinate, as detection tells it.
[[nodiscard]] BoardView ObserveBoard(const Experiment& experiment, const Scene& scene, const RigSensor& camera,
                                     std::size_t capture_idx);
constexpr double kPlateMargin_m = 0.03;
// The scan's points on a board, kPlateMargin_m and more inside the plate's edge, as a search gives them: one candidate,
// or none where less than four beams or twenty points meet the plate. They are points of the scan that a cloud file
// would hold.
[[nodiscard]] std::vector<ScanPoint> PlatePoints(const Experiment& experiment, const Scene& scene,
                                                 const RigSensor& lidar, const TargetId& board,
                                                 std::size_t capture_idx);
[[nodiscard]] CloudView ObservePlate(const Experiment& experiment, const Scene& scene, const RigSensor& lidar,
                                     const TargetId& board, std::size_t capture_idx);

// Everything at once; sensors and captures whose file is missing are left out.
struct Observations {
  std::map<SensorId, std::map<CaptureId, BoardView>> views;
  std::map<SensorId, std::map<CaptureId, std::map<TargetId, CloudView>>> clouds;
  std::map<SensorId, std::vector<TrackerRow>> tracker;
};
// The same for the same experiment, on any number of threads.
[[nodiscard]] Observations Observe(const Experiment& experiment);

}  // namespace rigcal::sim
