// The text files of a simulated session folder.
#pragma once

#include <string>

#include "client/sim/visit/experiment.h"

namespace rigcal::sim {

// docs/session-format.md.
[[nodiscard]] std::string SessionYaml(const Experiment& experiment);
// What the tracker says of its body, with its noise: one row per recorded capture.
struct TrackerRow {
  std::size_t capture_idx;
  Se3 T_world_body;
};
// In the order of the captures; those that are not recorded, or whose file is missing, are left out.
[[nodiscard]] std::vector<TrackerRow> TrackerRows(const Experiment& experiment, const RigSensor& tracker);
// The table "<tracker>/poses.csv", with its heading; where bodies do not stand still at captures, with the tracker's
// path of kPathHalf_s on either side of each row, with noise of its own.
constexpr double kPathHalf_s = 0.25, kPathStep_s = 0.01;
[[nodiscard]] std::string PosesCsv(const Experiment& experiment, const RigSensor& tracker,
                                   const std::vector<TrackerRow>& rows);

}  // namespace rigcal::sim
