// truth.yaml: what was true in a simulation, for those who judge a calibration by it.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "client/sim/visit/experiment.h"

namespace rigcal::sim {

// Standard deviations that no unbiased estimate from these data can undercut (Cramer & Rao), along and about the axes
// of the sensor (right tangent); nothing where the data do not tell that coordinate.
using BoundSigma = std::array<std::optional<double>, 6>;

struct SensorTruth {
  SensorKind kind = SensorKind::kCamera;
  Se3 T_ref_sensor;
  std::optional<Se3> T_ref_bumped;  // from capture `bumped_from_idx` on
  std::optional<CameraIntrinsics> intrinsics;
  std::optional<BoundSigma> bound;
};

struct BoardTruth {
  double square_m = 0.0;
  Se3 T_world_board;
};

struct CaptureTruth {
  CaptureId capture;
  Se3 T_world_ref;
};

struct Truth {
  std::string rig;
  std::uint64_t seed = 0;
  SensorId reference;
  std::size_t bumped_from_idx = 0;
  std::map<SensorId, SensorTruth> sensors;
  std::map<TargetId, BoardTruth> boards;
  std::vector<CaptureTruth> captures;
  std::map<std::string, std::string> disturbances;  // in words, by option; none: no line of the file
};

// Without bounds.
[[nodiscard]] Truth TruthOf(const Experiment& experiment);
[[nodiscard]] std::string WriteTruth(const Truth& truth);
// `name` is used in errors.
[[nodiscard]] Result<Truth> ReadTruth(std::string_view text, const std::string& name);

}  // namespace rigcal::sim
