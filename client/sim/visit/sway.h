// How a body that does not stop for its captures moves about each of them, and what a tracker with a clock of its own
// tells of it.
#pragma once

#include "client/sim/visit/experiment.h"

namespace rigcal::sim {

[[nodiscard]] bool IsSwaying(const Experiment& experiment);
// Pose of the body `since_s` after a capture in the body at the capture; the identity where bodies stand still. A
// harmonic motion of 0.3 to 0.8 Hz whose velocity and acceleration are drawn from the seed; level where the visit is.
[[nodiscard]] Se3 SwayOf(const Experiment& experiment, std::size_t capture_idx, double since_s);
// Pose of the tracker in the world that it tells for `since_s` after a capture, without noise: by its clock, which is
// late, that of a moment before. Of a robot that carries a board: pose of its flange in its base, which is the sensor.
[[nodiscard]] Se3 ToldByTracker(const Experiment& experiment, const RigSensor& tracker, std::size_t capture_idx,
                                double since_s);

}  // namespace rigcal::sim
