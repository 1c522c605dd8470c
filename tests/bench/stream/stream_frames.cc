// What free-running cameras of a simulated rig send while a board is waved before them: stream_frames RIG.yaml OUT SEED
// PLACES pauses|wandering [RATE_HZ OFFSET_S DRIFT_RATIO]... (three per camera, in the rig's order) writes session.yaml,
// truth.yaml and <camera>/<number>.jpg, and prints one JSON object: the stamps of each.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "client/sim/rig/random.h"
#include "client/sim/rig/rig_yaml.h"
#include "client/sim/truth.h"
#include "client/sim/views/picture.h"
#include "client/sim/visit/session_text.h"
#include "server/base/process/parallel_for.h"
#include "tests/bench/stream/waved_board.h"

namespace rigcal {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kStart_ns = 1'769'860'800'000'000'000;
constexpr double kExposure_s = 0.008, kBlurredFrom_m_s = 0.03, kDelay_s = 0.015;
constexpr int kPartsOfExposure = 3;

struct Clock {
  double rate_hz = 10, offset_s = 0, drift_ratio = 0;
};

// One picture: when it was taken, what its camera's clock said, and when the recorder had it.
struct Frame {
  std::size_t sensor = 0, number = 0;
  double t_s = 0;
  std::int64_t stamp_ns = 0, log_ns = 0;
};

std::vector<Frame> FramesOf(const std::vector<Clock>& clocks, double duration_s, std::uint64_t seed) {
  std::vector<Frame> frames;
  for (std::size_t s = 0; s < clocks.size(); ++s) {
    sim::Random random(sim::KeyOf(seed, "frames", {}, s));
    const double period_s = 1.0 / clocks[s].rate_hz;
    double t_s = 0.05 + period_s * random.Uniform();
    for (std::size_t k = 0; t_s < duration_s - 0.05; ++k, t_s += period_s) {
      const double told_s = t_s + clocks[s].offset_s + clocks[s].drift_ratio * t_s;
      frames.push_back({s, k, t_s, kStart_ns + std::llround(told_s * 1e9),
                        kStart_ns + std::llround((t_s + kDelay_s * random.Uniform(0.5, 1.5)) * 1e9)});
    }
  }
  return frames;
}

// The mean of what it sees while it is open.
sim::Picture Exposed(const sim::Scene& scene, const sim::RigSensor& camera, const sim::RayGrid& grid,
                     const WavedBoard& board, double t_s, std::uint64_t key) {
  const bool blurs = board.Speed_m_s(t_s) > kBlurredFrom_m_s;
  const int parts = blurs ? kPartsOfExposure : 1;
  std::vector<int> sums;
  sim::Picture picture;
  for (int i = 0; i < parts; ++i) {
    const double at_s = t_s + kExposure_s * ((i + 0.5) / parts - 0.5);
    picture = TakePicture(scene, camera.camera, grid, board.T_world_body(at_s) * camera.T_body_sensor, key);
    sums.resize(picture.bgr.size());
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += picture.bgr[k];
  }
  for (std::size_t k = 0; k < sums.size(); ++k) picture.bgr[k] = static_cast<std::uint8_t>(sums[k] / parts);
  return picture;
}

bool WriteBytes(const fs::path& path, const std::string& bytes) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return static_cast<bool>(file.flush());
}

bool WriteFrames(const sim::Experiment& experiment, const WavedBoard& board, const std::vector<Frame>& frames,
                 const fs::path& out) {
  const sim::Scene scene = SceneAt(experiment, 0);
  std::vector<sim::RayGrid> grids;
  for (const sim::RigSensor& sensor : experiment.rig.sensors) {
    grids.emplace_back(sensor.camera);
    fs::create_directories(out / sensor.id.str());
  }
  std::vector<char> written(frames.size(), 0);
  ParallelFor(frames.size(), [&](std::size_t i) {
    const Frame& frame = frames[i];
    const sim::RigSensor& camera = experiment.rig.sensors[frame.sensor];
    const std::uint64_t key = sim::KeyOf(experiment.options.seed, "frame", camera.id.str(), frame.number);
    const auto bytes =
        Encoded(Exposed(scene, camera, grids[frame.sensor], board, frame.t_s, key), sim::PictureFormat::kJpeg);
    const fs::path path = out / camera.id.str() / (std::to_string(frame.number) + ".jpg");
    written[i] = bytes && WriteBytes(path, *bytes) ? 1 : 0;
  });
  return std::find(written.begin(), written.end(), 0) == written.end();
}

void PrintFrames(const sim::Experiment& experiment, const std::vector<Frame>& frames, double duration_s) {
  std::printf("{\"start_ns\": %lld, \"duration_s\": %.6f, \"frames\": [", static_cast<long long>(kStart_ns),
              duration_s);
  for (std::size_t i = 0; i < frames.size(); ++i)
    std::printf("%s[\"%s\", %zu, %lld, %lld]", i == 0 ? "" : ", ",
                experiment.rig.sensors[frames[i].sensor].id.str().c_str(), frames[i].number,
                static_cast<long long>(frames[i].stamp_ns), static_cast<long long>(frames[i].log_ns));
  std::printf("]}\n");
}

int Run(int argc, char** argv) {
  auto rig = sim::LoadRig(argv[1]);
  if (!rig || argc != 6 + 3 * static_cast<int>(rig->sensors.size())) {
    std::fprintf(stderr, "%s: no rig, or not three numbers for each of its cameras\n", argv[1]);
    return 2;
  }
  std::vector<Clock> clocks;
  for (int i = 6; i + 2 < argc; i += 3)
    clocks.push_back({std::atof(argv[i]), std::atof(argv[i + 1]), std::atof(argv[i + 2])});
  sim::Options options;
  options.seed = static_cast<std::uint64_t>(std::atoll(argv[3]));
  options.captures = std::atoi(argv[4]);
  const auto experiment = sim::Prepare(*std::move(rig), options);
  if (!experiment) return 2;
  WavedBoardOptions hand;
  hand.seed = options.seed;
  hand.pauses = std::string(argv[5]) == "pauses";
  const WavedBoard board(experiment->T_world_body, hand);
  const std::vector<Frame> frames = FramesOf(clocks, board.Duration_s(), options.seed);
  const fs::path out = argv[2];
  fs::create_directories(out);
  if (!WriteBytes(out / "session.yaml", sim::SessionYaml(*experiment)) ||
      !WriteBytes(out / "truth.yaml", sim::WriteTruth(sim::TruthOf(*experiment))) ||
      !WriteFrames(*experiment, board, frames, out))
    return 1;
  PrintFrames(*experiment, frames, board.Duration_s());
  return 0;
}

}  // namespace
}  // namespace rigcal

int main(int argc, char** argv) {
  if (argc < 6) {
    std::fprintf(stderr,
                 "usage: stream_frames RIG.yaml OUT SEED PLACES pauses|wandering [RATE_HZ OFFSET_S DRIFT_RATIO]...\n");
    return 2;
  }
  return rigcal::Run(argc, argv);
}
