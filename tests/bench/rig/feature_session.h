// A virtual robot's visit at feature level: what its sensors observe goes straight into the estimators and the graph,
// as the pipeline puts it there, without pictures, files or a server.
#pragma once

#include <map>
#include <vector>

#include "client/sim/visit/observe.h"
#include "server/calib/camera/camera_memory.h"
#include "server/calib/lidar_camera/lidar_camera.h"
#include "server/calib/lidar_lidar/lidar_lidar.h"
#include "server/calib/motion/hand_eye.h"
#include "server/calib/stereo/stereo.h"
#include "server/model/graph/graph.h"

namespace rigcal {

// A turn of fewer firings than the lidar's: it is whole clouds that take the time.
inline constexpr int kFewFirings = 4;

struct FeatureSession {
  sim::Experiment experiment;
  SessionHeader header;  // what session.yaml says, with the pairs that are not calibrated
  sim::Observations seen;
  std::map<SensorId, std::map<CaptureId, std::vector<Eigen::Vector3f>>>
      clouds;  // of lidars that are calibrated together
};

// Whole clouds, of every `of_firings`-th firing, are drawn for `lidar_captures` captures at most, evenly spread; 0:
// none, and no pair of lidars.
[[nodiscard]] FeatureSession RecordFeatures(const sim::Experiment& experiment, std::size_t lidar_captures,
                                            int of_firings = kFewFirings);

[[nodiscard]] calib::StereoProblem StereoOf(const FeatureSession& session, const SensorPair& pair);
[[nodiscard]] calib::LidarCameraProblem LidarCameraOf(const FeatureSession& session, const SensorPair& pair);
[[nodiscard]] calib::LidarLidarProblem LidarLidarOf(const FeatureSession& session, const SensorPair& pair);
[[nodiscard]] calib::HandEyeProblem HandEyeOf(const FeatureSession& session, const SensorPair& pair);

// The pairs that it has data for, in the header's order.
[[nodiscard]] std::vector<SensorPair> PairsOf(const FeatureSession& session);
[[nodiscard]] Edge EdgeOf(const FeatureSession& session, const SensorPair& pair,
                          calib::CameraMemory* cameras = nullptr);
[[nodiscard]] std::vector<Edge> EdgesOf(const FeatureSession& session);
// Optimum of the good edges, its covariances by the jackknife through the graph.
[[nodiscard]] GraphSolution SolveRig(const std::vector<Edge>& edges, const SensorId& reference);

}  // namespace rigcal
