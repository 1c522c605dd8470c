// What chance does to errors in sigmas where every sigma is right: sigma_chance BLOCKS RANK ESTIMATES [REPEATS]
// An estimate is the mean of so many vectors of a normal distribution with known covariance, along RANK directions; its
// uncertainty is put together as those of estimators with a jackknife are, shrunk towards the model, which is the truth
// here. No sensor, no solver, no approximation; every estimate independent of the others. Prints one JSON object: of
// the largest error over sigma among ESTIMATES, how often it is beyond 4, its median and what 5 % exceed, in the
// principal directions of the information and along the axes told.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "client/sim/rig/random.h"
#include "server/base/process/parallel_for.h"
#include "server/calib/core/leave_one_out.h"
#include "server/math/statistics.h"
#include "tests/bench/rig/rig_coverage.h"

namespace rigcal {
namespace {

constexpr double kSigma_m = 1e-3;

struct Setting {
  int blocks = 0, rank = 0, estimates = 0;
};

struct Drawn {
  Vector6d error = Vector6d::Zero();
  Uncertainty uncertainty;
};

Drawn MeanOf(const Setting& setting, sim::Random& random) {
  std::vector<Vector6d> drawn(static_cast<std::size_t>(setting.blocks), Vector6d::Zero());
  Vector6d mean = Vector6d::Zero();
  for (Vector6d& one : drawn) {
    for (int i = 0; i < setting.rank; ++i) one[i] = kSigma_m * random.Normal();
    mean += one / setting.blocks;
  }
  std::vector<BlockVector> blocks;
  for (const Vector6d& one : drawn)
    blocks.push_back({std::to_string(blocks.size()), (mean - one) / (setting.blocks - 1)});
  const Eigen::MatrixXd C_mean =
      kSigma_m * kSigma_m / setting.blocks * Eigen::MatrixXd::Identity(setting.rank, setting.rank);
  auto uncertainty =
      calib::UncertaintyAlong(Matrix6d::Identity().leftCols(setting.rank), C_mean, std::move(blocks), {}, drawn.size());
  if (uncertainty) return {-mean, std::move(*uncertainty)};
  std::fprintf(stderr, "%s\n", Sentence(uncertainty.error()).c_str());
  std::exit(1);
}

struct Largest {
  double principal = 0, axis = 0;
  int covered = 0;
};

Largest LargestOf(const Setting& setting, std::uint64_t key) {
  sim::Random random(key);
  Largest largest;
  for (int i = 0; i < setting.estimates; ++i) {
    const auto [error, uncertainty] = MeanOf(setting, random);
    largest.principal = std::max(largest.principal, ClaimedSigmas(error, uncertainty).maxCoeff());
    largest.axis = std::max(largest.axis, WorstKnownAxis(error, uncertainty));
    largest.covered += error.dot(uncertainty.Omega * error) <= HotellingLimit(setting.blocks, setting.rank) ? 1 : 0;
  }
  return largest;
}

void Print(const char* name, std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto beyond = static_cast<double>(values.end() - std::upper_bound(values.begin(), values.end(), 4.0));
  std::printf("\"%s\": {\"beyond_4_ratio\": %.4f, \"median\": %.3f, \"exceeded_by_5_percent\": %.3f}, ", name,
              beyond / static_cast<double>(values.size()), values[values.size() / 2], values[values.size() * 95 / 100]);
}

void Measure(const Setting& setting, std::size_t repeats) {
  std::vector<Largest> largest(repeats);
  ParallelFor(repeats, [&](std::size_t i) { largest[i] = LargestOf(setting, sim::KeyOf(1, "chance", "", i)); });
  std::vector<double> principal, axis;
  int covered = 0;
  for (const Largest& one : largest) {
    principal.push_back(one.principal), axis.push_back(one.axis);
    covered += one.covered;
  }
  std::printf("{");
  Print("principal", principal);
  Print("axis", axis);
  std::printf("\"covered_ratio\": %.4f}\n", covered / (static_cast<double>(repeats) * setting.estimates));
}

}  // namespace
}  // namespace rigcal

int main(int argc, char** argv) {
  const auto number = [&](int i, int fallback) { return argc > i ? std::atoi(argv[i]) : fallback; };
  const rigcal::Setting setting{number(1, 0), number(2, 0), number(3, 0)};
  const int repeats = number(4, 1000);
  if (setting.blocks < 8 || setting.rank < 1 || setting.rank > 6 || setting.estimates < 1 || repeats < 1) {
    std::fprintf(stderr, "usage: sigma_chance BLOCKS RANK ESTIMATES [REPEATS]   (8 blocks at least, rank 1 to 6)\n");
    return 2;
  }
  rigcal::Measure(setting, static_cast<std::size_t>(repeats));
  return 0;
}
