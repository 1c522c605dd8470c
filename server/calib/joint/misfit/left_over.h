// How much of what was seen an explanation leaves unexplained: what explanations of one session are compared by.
#pragma once

#include <vector>

#include "server/calib/joint/misfit/explained.h"

namespace rigcal::calib::joint {

constexpr double kBeyondDoubt = 20.0;  // in twice the log likelihood: odds of e^10

// Twice the negative logarithm of the likelihood of all that was seen, but for what is the same for any explanation, at
// the noise that it leaves. `in_burst`: of looks of corners, the same for all explanations that are compared.
[[nodiscard]] double Unexplained(const Explained& explained, const std::vector<double>& in_burst);

// The same with a noise of its own for what the sensor of this name saw before `group` and from it on, in any
// explanation: a second pose brings a second noise with it, which a second lens does not.
[[nodiscard]] double UnexplainedInTwo(const Explained& explained, const std::vector<double>& in_burst,
                                      const SensorId& name, int group);

// With what its fields, moves and lenses had to choose from (Schwarz 1978), and what pulls at given intrinsics.
[[nodiscard]] double LeftOver(const Explained& explained, const std::vector<double>& in_burst);

}  // namespace rigcal::calib::joint
