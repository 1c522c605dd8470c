// The paper's synthetic experiment (section IV-A): noise on the edges of a small graph, before and after optimisation.
#pragma once

#include <vector>

#include "tests/paper/page.h"

namespace rigcal::paper {

// Sums over the edges of one data set, of |e|^2 against the truth: e = Log(T_true^-1 T).
struct NoiseSums {
  double translation_m2 = 0.0, rotation_rad2 = 0.0;
  double whitened = 0.0;  // e^T Omega e
};

struct NoiseSet {
  NoiseSums noise;      // of the edges as measured
  NoiseSums optimised;  // of the same edges, from the poses of the solution
};

struct NoiseExperiment {
  double sigma_m = 0.0, sigma_rad = 0.0;  // of the noise, per axis
  std::vector<NoiseSet> sets;
  NoiseSums expected_noise, expected_optimised;  // by the linear prediction, the diagonal blocks of J H^-1 J^T
};

// Four vertices, every pair an edge, isotropic noise N(0, Sigma), one random rig per set. Deterministic.
[[nodiscard]] NoiseExperiment RunNoiseExperiment(int sets, double sigma_m, double sigma_rad, unsigned seed);

// Mean over the sets of one sum; before and after.
[[nodiscard]] NoiseSums MeanNoise(const NoiseExperiment& experiment);
[[nodiscard]] NoiseSums MeanOptimised(const NoiseExperiment& experiment);
// Section of the page: both figures, ratios against the prediction.
[[nodiscard]] Section NoiseSection(const NoiseExperiment& experiment);
// The largest ratio of whitened sums, optimised over noise, among the sets.
[[nodiscard]] double LargestRatio(const NoiseExperiment& experiment);

}  // namespace rigcal::paper
