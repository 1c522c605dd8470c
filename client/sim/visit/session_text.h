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
// The table "<tracker>/poses.csv", with its heading.
[[nodiscard]] std::string PosesCsv(const Experiment& experiment, const std::vector<TrackerRow>& rows);

}  // namespace rigcal::sim
