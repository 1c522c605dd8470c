// The figures of all experiments as one document, experiment.json.
#pragma once

#include <nlohmann/json.hpp>

#include "tests/paper/chain_experiment.h"
#include "tests/paper/global_experiment.h"
#include "tests/paper/method_experiment.h"
#include "tests/paper/noise_experiment.h"

namespace rigcal::paper {

[[nodiscard]] nlohmann::json FiguresOf(const NoiseExperiment& experiment);
[[nodiscard]] nlohmann::json FiguresOf(const GlobalExperiment& experiment);
[[nodiscard]] nlohmann::json FiguresOf(const ChainExperiment& experiment);
[[nodiscard]] nlohmann::json FiguresOf(const MethodExperiment& experiment);

}  // namespace rigcal::paper
