// What a person would write into session.yaml: measured boards, calibrated lenses, poses from the drawing.
#pragma once

#include <vector>

#include "client/sim/visit/experiment.h"

namespace rigcal::sim {

// Everything but the pairs that are not calibrated. `boards`: at the size that they are thought to have.
[[nodiscard]] SessionHeader Declare(const Experiment& experiment, const std::vector<RigBoard>& boards, Stamp start);

}  // namespace rigcal::sim
