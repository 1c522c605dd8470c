// Runs the paper's experiments on simulated truth, writes one page and prints one JSON object.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/paper/noise_experiment.h"
#include "tests/paper/page.h"

namespace rigcal::paper {
namespace {

// Those of a careful pairwise calibration.
constexpr double kSigma_m = 0.005, kSigma_rad = 0.3 / 57.29577951308232;

nlohmann::json Figures(const NoiseExperiment& experiment) {
  const NoiseSums noise = MeanNoise(experiment), optimised = MeanOptimised(experiment);
  const NoiseSums &before = experiment.expected_noise, &after = experiment.expected_optimised;
  return {{"sets", experiment.sets.size()},
          {"whitened_ratio", optimised.whitened / noise.whitened},
          {"whitened_ratio_largest", LargestRatio(experiment)},
          {"translation_ratio", optimised.translation_m2 / noise.translation_m2},
          {"translation_ratio_predicted", after.translation_m2 / before.translation_m2},
          {"rotation_ratio", optimised.rotation_rad2 / noise.rotation_rad2},
          {"rotation_ratio_predicted", after.rotation_rad2 / before.rotation_rad2}};
}

bool Write(const std::string& path, const std::string& page) {
  std::ofstream file(path, std::ios::binary);
  file << page;
  return static_cast<bool>(file.flush());
}

int Main(int argc, char** argv) {
  CLI::App app("Runs the paper's experiments on simulated truth");
  std::string out = "paper.html";
  int sets = 300;
  app.add_option("--out", out, "The page to write")->capture_default_str();
  app.add_option("--sets", sets, "Data sets of the noise experiment")
      ->capture_default_str()
      ->check(CLI::Range(1, 100000));
  CLI11_PARSE(app, argc, argv);
  const NoiseExperiment noise = RunNoiseExperiment(sets, kSigma_m, kSigma_rad);
  if (!Write(out, Page({NoiseSection(noise)}))) {
    std::fprintf(stderr, "paper_experiment: cannot write %s. Give another file with --out.\n", out.c_str());
    return 1;
  }
  std::printf("%s\n", nlohmann::json{{"noise", Figures(noise)}, {"page", out}}.dump().c_str());
  return 0;
}

}  // namespace
}  // namespace rigcal::paper

int main(int argc, char** argv) { return rigcal::paper::Main(argc, argv); }
