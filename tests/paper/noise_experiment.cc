#include "tests/paper/noise_experiment.h"

#include <algorithm>

#include "tests/unit/graph/random.h"

namespace rigcal::paper {
namespace {

using graph::RandomRig;

constexpr std::size_t kVertices = 4, kEdges = 6;

Se3 TruthOf(const RandomRig& rig, const GraphEdge& edge) {
  return rig.truth[std::stoul(edge.frame_a.str())].Inverse() * rig.truth[std::stoul(edge.frame_b.str())];
}

// Every pair of vertices once; edges hold the truth.
RandomRig CompleteRig(unsigned seed, double sigma_m, double sigma_rad) {
  RandomRig rig = graph::MakeRig(kVertices, kEdges, seed, sigma_m, sigma_rad, false);
  std::size_t k = 0;
  for (std::size_t a = 0; a < kVertices; ++a)
    for (std::size_t b = a + 1; b < kVertices; ++b, ++k) {
      GraphEdge& edge = rig.graph.edges[k];
      edge.frame_a = graph::Name(a);
      edge.frame_b = graph::Name(b);
      edge.T_a_b = TruthOf(rig, edge);
    }
  return rig;
}

void Add(const Vector6d& e, const Matrix6d& Omega, NoiseSums& sums) {
  sums.translation_m2 += e.head<3>().squaredNorm();
  sums.rotation_rad2 += e.tail<3>().squaredNorm();
  sums.whitened += e.dot(Omega * e);
}

void AddTrace(const Matrix6d& C, const Matrix6d& Omega, double weight, NoiseSums& sums) {
  sums.translation_m2 += weight * C.topLeftCorner<3, 3>().trace();
  sums.rotation_rad2 += weight * C.bottomRightCorner<3, 3>().trace();
  sums.whitened += weight * (Omega * C).trace();
}

// What the covariances say the mean of the sets will be: this set's part of it.
void AddExpected(const RandomRig& exact, double weight, NoiseExperiment& experiment) {
  const GraphSolution solution = graph::Solve(exact.graph);
  for (const GraphEdge& edge : exact.graph.edges) {
    const auto relative = graph::Relative(exact.graph, solution, edge.frame_a, edge.frame_b);
    AddTrace(edge.Omega.inverse(), edge.Omega, weight, experiment.expected_noise);
    if (relative) AddTrace(relative->covariance, edge.Omega, weight, experiment.expected_optimised);
  }
}

NoiseSet RunSet(RandomRig rig, unsigned seed) {
  NoiseSet set;
  std::mt19937 random(seed);
  for (GraphEdge& edge : rig.graph.edges) {
    const Vector6d e = graph::DrawError(random, edge.Omega);
    edge.T_a_b = TruthOf(rig, edge) * Se3::Exp(e);
    Add(e, edge.Omega, set.noise);
  }
  const GraphSolution solution = graph::Solve(rig.graph);
  for (const GraphEdge& edge : rig.graph.edges) {
    const Se3 T = solution.poses[std::stoul(edge.frame_a.str())].T_ref_sensor.Inverse() *
                  solution.poses[std::stoul(edge.frame_b.str())].T_ref_sensor;
    Add((TruthOf(rig, edge).Inverse() * T).Log(), edge.Omega, set.optimised);
  }
  return set;
}

void AddPart(const NoiseSums& sums, double weight, NoiseSums& mean) {
  mean.translation_m2 += weight * sums.translation_m2;
  mean.rotation_rad2 += weight * sums.rotation_rad2;
  mean.whitened += weight * sums.whitened;
}

}  // namespace

NoiseExperiment RunNoiseExperiment(int sets, double sigma_m, double sigma_rad, unsigned seed) {
  NoiseExperiment experiment{sigma_m, sigma_rad, {}, {}, {}};
  for (int set = 0; set < sets; ++set) {
    const unsigned first = 1'000'000 * (seed - 1) + static_cast<unsigned>(set);
    const RandomRig rig = CompleteRig(1000 + first, sigma_m, sigma_rad);
    AddExpected(rig, 1.0 / sets, experiment);
    experiment.sets.push_back(RunSet(rig, 5000 + first));
  }
  return experiment;
}

NoiseSums MeanNoise(const NoiseExperiment& experiment) {
  NoiseSums mean;
  for (const NoiseSet& set : experiment.sets)
    AddPart(set.noise, 1.0 / static_cast<double>(experiment.sets.size()), mean);
  return mean;
}

NoiseSums MeanOptimised(const NoiseExperiment& experiment) {
  NoiseSums mean;
  for (const NoiseSet& set : experiment.sets)
    AddPart(set.optimised, 1.0 / static_cast<double>(experiment.sets.size()), mean);
  return mean;
}

double LargestRatio(const NoiseExperiment& experiment) {
  double largest = 0.0;
  for (const NoiseSet& set : experiment.sets) largest = std::max(largest, set.optimised.whitened / set.noise.whitened);
  return largest;
}

}  // namespace rigcal::paper
