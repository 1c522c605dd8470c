// The captures of one sensor pair as calib wants them, and the pictures that show what was found.
#pragma once

#include <vector>

#include "server/calib/lidar_camera/lidar_camera.h"
#include "server/calib/lidar_lidar/lidar_lidar.h"
#include "server/calib/motion/hand_eye.h"
#include "server/calib/stereo/stereo.h"
#include "server/calib/tracker_lidar/tracker_lidar.h"
#include "server/pipeline/edges/decoding.h"
#include "server/pipeline/edges/sightings.h"

namespace rigcal::pipeline {

template <typename Problem>
struct PairInputs {
  Problem problem;
  std::vector<Evidence> evidence;     // annotated pictures, in capture order, sensor a before sensor b
  std::vector<Diagnosis> notes = {};  // what a reader of the edge should know of its data
};
// Both sensors of a pair, as the session has them: kInternal where it lacks one.
struct SensorsOfPair {
  const Sensor *a = nullptr, *b = nullptr;
};
[[nodiscard]] Result<SensorsOfPair> FindSensors(const SessionHeader& header, const SensorPair& pair);

// Of the targets that both may see, the one found by both in most captures (the first, if equal).
[[nodiscard]] Result<PairInputs<calib::StereoProblem>> LoadStereo(storage::Store& store, const Manifest& manifest,
                                                                  const SensorPair& pair);
[[nodiscard]] Result<PairInputs<calib::LidarCameraProblem>> LoadLidarCamera(storage::Store& store,
                                                                            const Manifest& manifest,
                                                                            const SensorPair& pair);
// Of the targets that a camera may see, the one found in most captures. A table of poses that cannot be read is an
// error.
[[nodiscard]] Result<PairInputs<calib::HandEyeProblem>> LoadHandEye(storage::Store& store, const Manifest& manifest,
                                                                    const SensorPair& pair, Method method);
// No target: every capture of either, with both clouds as they were decoded.
[[nodiscard]] Result<PairInputs<calib::LidarLidarProblem>> LoadLidarLidar(storage::Store& store,
                                                                          const Manifest& manifest,
                                                                          const SensorPair& pair);
// Every plate that the lidar may see, and every capture of either sensor. A table of poses that cannot be read is an
// error.
[[nodiscard]] Result<PairInputs<calib::TrackerLidarProblem>> LoadTrackerLidar(storage::Store& store,
                                                                              const Manifest& manifest,
                                                                              const SensorPair& pair);
// What it takes of memory to register the clouds that LoadLidarLidar loads.
[[nodiscard]] Needed ToRegister(const storage::Store& store, const Manifest& manifest, const SensorPair& pair);
// How a pair of lidars came to fit, in its first used captures: stored, and added to the edge as evidence. Nothing for
// an edge without a pose.
[[nodiscard]] Status AddOverlays(storage::Store& store, const calib::LidarLidarProblem& problem, Edge& edge);

}  // namespace rigcal::pipeline
