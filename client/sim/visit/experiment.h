// One visit to a virtual robot before anything is recorded: what is true, and what a person would write down of it.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "client/sim/rig/rig.h"
#include "client/sim/rig/scene.h"
#include "client/sim/visit/disturbance.h"

namespace rigcal::sim {

enum class MotionKind { kFree, kPlanar, kSpot };             // all directions; level; turning about one upright axis
enum class IntrinsicsKind { kExact, kCalibrated, kAbsent };  // what session.yaml says of the lenses

struct Options {
  std::uint64_t seed = 1;
  std::optional<int> captures;   // otherwise the rig's
  double scale_ratio = 1.0;      // of the pictures' size
  double noise_factor = 1.0;     // on grey values, corners, ranges, tracker and intrinsics
  double dropout_ratio = 0.0;    // of the files that are missing
  std::optional<SensorId> bump;  // moved during the visit, by bump_m and bump_rad; the reference, too
  double bump_m = 0.005, bump_rad = 0.00873;
  double bump_at_ratio = 0.5;  // of the captures that were taken before
  MotionKind motion = MotionKind::kFree;
  std::optional<double> tilt_rms_rad;  // otherwise the rig's
  double board_scale_ratio = 1.0;      // true size of the boards over what session.yaml says
  double lidar_bias_sigma_m = 0.0;     // of each beam's own constant error
  IntrinsicsKind intrinsics = IntrinsicsKind::kCalibrated;
  Disturbances disturb;
  std::string captured_at = "2026-01-31T12:00:00Z";
};

struct MovedBoard {
  TargetId board;
  Se3 T_world_plate;
  std::size_t from_idx = 0;
};
struct TakenElsewhere {
  SensorId sensor;
  std::size_t capture_idx = 0;
  Se3 T_world_body;
};
struct ShiftedPicture {
  SensorId sensor;
  std::size_t capture_idx = 0;
  Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();
};

struct RefocusedCamera {
  SensorId sensor;
  std::size_t from_idx = 0;
  double by_ratio = 0.0;
};

struct Experiment {
  Options options;
  Rig rig;                 // true: lenses at their scale, boards at their true size
  SessionHeader declared;  // what session.yaml says
  std::vector<CaptureId> captures;
  std::vector<std::int64_t> stamps_ns;                  // of the tracker's clock
  std::vector<Se3> T_world_body;                        // per capture
  std::map<SensorId, Se3> T_body_bumped;                // of a bumped sensor, from capture `bumped_from_idx` on
  std::map<SensorId, std::vector<double>> beam_bias_m;  // per lidar and beam
  std::map<SensorId, std::vector<Se3>> T_rest_sensor;   // per capture, of sensors that do not stay on their mounts
  std::map<SensorId, std::vector<Se3>> T_told_world;    // per capture, of trackers that drift
  std::optional<SensorId> displaced;                    // by an excursion or a creep
  std::size_t bumped_from_idx = 0;
  std::optional<MovedBoard> moved_board;
  std::optional<TakenElsewhere> wrong_instant;
  std::optional<ShiftedPicture> shifted;
  std::optional<RefocusedCamera> refocused;

  // The true pose in the body, after a bump the bumped one; and in the world, where a sensor tells of another instant
  // the one of that. The sensor must exist.
  [[nodiscard]] Se3 T_body_sensor(const SensorId& id, std::size_t capture_idx) const;
  [[nodiscard]] Se3 T_world_sensor(const SensorId& id, std::size_t capture_idx) const;
  [[nodiscard]] RigBoard BoardAt(const TargetId& id, std::size_t capture_idx) const;  // must exist
  // A camera as it is at a capture: its lens may be focused anew. The sensor must be one.
  [[nodiscard]] CameraTruth CameraAt(const SensorId& id, std::size_t capture_idx) const;
  // By which a camera's whole picture is off.
  [[nodiscard]] Eigen::Vector2d ShiftOf(const SensorId& id, std::size_t capture_idx) const;
  [[nodiscard]] std::size_t BurstOf(std::size_t capture_idx) const;
  // The first capture after this part of all.
  [[nodiscard]] std::size_t IndexAt(double ratio) const;
  // Before a bump.
  [[nodiscard]] Se3 T_ref_sensor(const SensorId& id) const;
  // False: the file is missing.
  [[nodiscard]] bool IsRecorded(const SensorId& id, std::size_t capture_idx) const;
};

// Deterministic: the same rig and options give the same experiment.
[[nodiscard]] Result<Experiment> Prepare(Rig rig, const Options& options);
// What there is to see at a capture.
[[nodiscard]] Scene SceneAt(const Experiment& experiment, std::size_t capture_idx);

}  // namespace rigcal::sim
