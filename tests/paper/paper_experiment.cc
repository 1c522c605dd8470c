// Runs the paper's experiments on simulated truth: writes a page with its figures and experiment.json, and prints the
// same JSON.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "client/sim/rig/rig_yaml.h"
#include "tests/paper/experiment_json.h"

namespace rigcal::paper {
namespace {

namespace fs = std::filesystem;

// Those of a careful pairwise calibration.
constexpr double kSigma_m = 0.005, kSigma_rad = 0.3 / 57.29577951308232;

struct Settings {
  std::string out = "paper";
  int sets = 300, visits = 10, captures = 40, threads = 0;
  unsigned seed = 1;
};

bool Write(const fs::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  return static_cast<bool>(file.flush());
}

Result<std::vector<Visit>> MakeVisits(const Settings& settings) {
  RIGCAL_ASSIGN(const sim::Rig rig, sim::LoadRig("mars-mapper"));
  std::vector<Visit> visits;
  for (int k = 0; k < settings.visits; ++k) {
    sim::Options options;
    options.seed = 1000 * std::uint64_t{settings.seed} + static_cast<std::uint64_t>(k);
    options.captures = settings.captures;
    VisitOptions how;
    how.threads = settings.threads;
    RIGCAL_ASSIGN(Visit visit, MakeVisit(rig, options, how));
    visits.push_back(std::move(visit));
  }
  return visits;
}

std::string Introduction(const Settings& settings) {
  return fmt::format(
      "<p>Chen and Schwertfeger, <i>Heterogeneous Multi-sensor Calibration based on Graph Optimization</i> (RCAR "
      "2019), "
      "done again on simulated truth, with the estimators and the solver of the server. Seed {}; all figures are in <a "
      "href=\"experiment.json\">experiment.json</a>.</p>\n",
      settings.seed);
}

Result<nlohmann::json> Run(const Settings& settings) {
  const NoiseExperiment noise = RunNoiseExperiment(settings.sets, kSigma_m, kSigma_rad, settings.seed);
  RIGCAL_ASSIGN(const std::vector<Visit> visits, MakeVisits(settings));
  RIGCAL_ASSIGN(GlobalExperiment global, RunGlobalExperiment(visits, settings.sets, settings.seed));
  VisitOptions how;
  how.threads = settings.threads;
  RIGCAL_ASSIGN(global.noisy_pairs, TryNoisySensors(visits.front().experiment, global.noise_factor, how));
  const ChainExperiment chain = RunChainExperiment(visits);
  const MethodExperiment method = RunMethodExperiment(visits);
  const nlohmann::json figures = {{"seed", settings.seed},
                                  {"noise", FiguresOf(noise)},
                                  {"global", FiguresOf(global)},
                                  {"chain", FiguresOf(chain)},
                                  {"method", FiguresOf(method)}};
  auto files = PageFiles(Introduction(settings),
                         {NoiseSection(noise), GlobalSection(global), ChainSection(chain), MethodSection(method)});
  files.push_back({"experiment.json", figures.dump(1) + "\n"});
  std::error_code error;
  fs::create_directories(settings.out, error);
  for (const PageFile& file : files)
    if (!Write(fs::path(settings.out) / file.name, file.text))
      return Fail(ErrorCode::kStorage, "folder " + settings.out + " cannot be written",
                  "Give another folder with --out.");
  return figures;
}

int Main(int argc, char** argv) {
  CLI::App app("Runs the paper's experiments on simulated truth");
  Settings settings;
  app.add_option("--out", settings.out, "The folder to write")->capture_default_str();
  app.add_option("--sets", settings.sets, "Data sets of drawn noise")
      ->capture_default_str()
      ->check(CLI::Range(1, 100000));
  app.add_option("--visits", settings.visits, "Visits to the virtual MARS Mapper")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  app.add_option("--captures", settings.captures, "Captures of each visit")
      ->capture_default_str()
      ->check(CLI::Range(12, 1000));
  app.add_option("--seed", settings.seed, "Of all that is random")->capture_default_str()->check(CLI::Range(1, 1000));
  app.add_option("--threads", settings.threads, "0: as many as the machine has")->check(CLI::Range(0, 1000));
  CLI11_PARSE(app, argc, argv);
  const auto figures = Run(settings);
  if (!figures) {
    std::fprintf(stderr, "paper_experiment: %s\n", Sentence(figures.error()).c_str());
    return 1;
  }
  std::printf("%s\n", figures->dump().c_str());
  return 0;
}

}  // namespace
}  // namespace rigcal::paper

int main(int argc, char** argv) { return rigcal::paper::Main(argc, argv); }
