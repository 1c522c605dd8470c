// Sensors that do not stay on their mounts, trackers that drift: what a visit draws of them.
#pragma once

#include "client/sim/visit/experiment.h"

namespace rigcal::sim {

[[nodiscard]] Status CheckMounts(const Rig& rig, const Disturbances& disturb);
// Where each sensor is at each capture beside its rest, and each tracker's world beside the true one.
void LoosenMounts(Experiment& experiment);

}  // namespace rigcal::sim
