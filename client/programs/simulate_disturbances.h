// The options of `rigcal simulate` that break what a calibration takes for granted.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "client/sim/visit/experiment.h"

namespace rigcal::client {

// As written on the command line; empty: not asked for.
struct DisturbanceWords {
  std::string bump, bump_by, board_moved, wrong_instant, shift_capture, visit_scatter, sway, refocus;
  std::string excursion, creep, rattle, pose_drift;
  std::optional<double> pose_clock_offset_ms;
};

// Adds the options to `verb`; both outlive its parsing.
void AddDisturbances(CLI::App& verb, DisturbanceWords& words, sim::Options& simulation);
// The error names the option and shows how it is written.
[[nodiscard]] Status ReadDisturbances(const DisturbanceWords& words, sim::Options& simulation);

}  // namespace rigcal::client
