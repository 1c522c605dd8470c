#include "client/sim/simulate.h"

#include <time.h>

#include <fstream>
#include <mutex>
#include <thread>

#include "client/sim/rig/random.h"
#include "client/sim/views/scan.h"
#include "client/sim/visit/session_text.h"
#include "server/base/process/parallel_for.h"

namespace rigcal::sim {
namespace {

namespace fs = std::filesystem;

// Not durable on purpose: what is lost is simulated again.
Result<std::int64_t> Write(const fs::path& path, const std::string& bytes) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (file) return static_cast<std::int64_t>(bytes.size());
  return Fail(ErrorCode::kStorage, "file " + path.string() + " cannot be written",
              "Make room, or choose another folder.");
}

Status MakeFolders(const Experiment& experiment, const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_empty(folder, error))
    return Fail(ErrorCode::kConflict, "folder " + folder.string() + " is not empty",
                "Name a new folder: a session is never mixed with another.");
  fs::create_directories(folder, error);
  for (const RigSensor& sensor : experiment.rig.sensors) fs::create_directories(folder / sensor.id.str(), error);
  if (!error) return {};
  return Fail(ErrorCode::kStorage, "folder " + folder.string() + " cannot be made: " + error.message(),
              "Choose another folder.");
}

// One file to write: a sensor at a capture.
struct Shot {
  const RigSensor* sensor;
  std::size_t capture_idx;
};

std::vector<Shot> ShotsOf(const Experiment& experiment) {
  std::vector<Shot> shots;
  for (const RigSensor& sensor : experiment.rig.sensors)
    for (std::size_t k = 0; k < experiment.captures.size(); ++k)
      if (sensor.kind != SensorKind::kTracker && experiment.IsRecorded(sensor.id, k)) shots.push_back({&sensor, k});
  return shots;
}

// Processor time: what else the machine does is no property of ours.
double ThreadSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

class Recorder {
 public:
  Recorder(const Experiment& experiment, const fs::path& folder, const WriteOptions& options,
           const FilesProgress& progress)
      : experiment_(experiment), folder_(folder), options_(options), progress_(progress), shots_(ShotsOf(experiment)) {
    summary_.threads = options.threads > 0 ? options.threads : static_cast<int>(std::thread::hardware_concurrency());
  }

  Result<WriteSummary> Run() {
    MakeGrids();
    std::vector<Status> outcomes(shots_.size());
    ParallelFor(
        shots_.size(), [&](std::size_t i) { outcomes[i] = Record(shots_[i]); }, summary_.threads);
    for (const Status& outcome : outcomes) RIGCAL_TRY(outcome);
    for (const RigSensor& sensor : experiment_.rig.sensors)
      if (sensor.kind == SensorKind::kTracker)
        RIGCAL_TRY(Write(folder_ / sensor.id.str() / "poses.csv",
                         PosesCsv(experiment_, sensor, TrackerRows(experiment_, sensor))));
    return summary_;
  }

 private:
  void MakeGrids() {
    const auto& sensors = experiment_.rig.sensors;
    grids_.resize(sensors.size());
    ParallelFor(
        sensors.size(),
        [&](std::size_t i) {
          if (sensors[i].kind == SensorKind::kCamera) grids_[i].emplace(sensors[i].camera);
        },
        summary_.threads);
  }

  Status Record(const Shot& shot) {
    return shot.sensor->kind == SensorKind::kCamera ? Photograph(shot) : Measure(shot);
  }

  Status Photograph(const Shot& shot) {
    const double start_s = ThreadSeconds();
    const RigSensor& sensor = *shot.sensor;
    const auto& grid = grids_[static_cast<std::size_t>(shot.sensor - experiment_.rig.sensors.data())];
    const Eigen::Vector2d shift_px = experiment_.ShiftOf(sensor.id, shot.capture_idx);
    const CameraTruth camera = experiment_.CameraAt(sensor.id, shot.capture_idx);
    const bool is_usual = shift_px.isZero() && camera.intrinsics == sensor.camera.intrinsics;
    const Picture picture =
        TakePicture(SceneAt(experiment_, shot.capture_idx), sensor.camera, is_usual ? *grid : RayGrid(camera, shift_px),
                    experiment_.T_world_sensor(sensor.id, shot.capture_idx),
                    KeyOf(experiment_.options.seed, "picture", sensor.id.str(), shot.capture_idx));
    RIGCAL_ASSIGN(const std::string bytes, Encoded(picture, options_.format));
    const double spent_s = ThreadSeconds() - start_s;
    RIGCAL_ASSIGN(const std::int64_t written, Write(PathOf(shot, SuffixOf(options_.format)), bytes));
    const std::lock_guard lock(mutex_);
    ++summary_.pictures;
    summary_.pixels += std::int64_t{picture.width_px} * picture.height_px;
    summary_.pictures_s += spent_s;
    Tell(written);
    return {};
  }

  Status Measure(const Shot& shot) {
    const RigSensor& sensor = *shot.sensor;
    const std::vector<ScanPoint> points =
        Scan(SceneAt(experiment_, shot.capture_idx), sensor.lidar,
             experiment_.T_world_sensor(sensor.id, shot.capture_idx), experiment_.beam_bias_m.at(sensor.id),
             KeyOf(experiment_.options.seed, "scan", sensor.id.str(), shot.capture_idx));
    RIGCAL_ASSIGN(const std::int64_t written, Write(PathOf(shot, "pcd"), PcdOf(points)));
    const std::lock_guard lock(mutex_);
    ++summary_.clouds;
    summary_.points += points.size();
    Tell(written);
    return {};
  }

  [[nodiscard]] fs::path PathOf(const Shot& shot, const std::string& suffix) const {
    return folder_ / shot.sensor->id.str() / (experiment_.captures[shot.capture_idx].str() + "." + suffix);
  }

  void Tell(std::int64_t written) {
    summary_.bytes += written;
    if (progress_) progress_(summary_.pictures + summary_.clouds, shots_.size());
  }

  const Experiment& experiment_;
  const fs::path& folder_;
  const WriteOptions& options_;
  const FilesProgress& progress_;
  const std::vector<Shot> shots_;
  std::vector<std::optional<RayGrid>> grids_;
  std::mutex mutex_;  // guards what follows
  WriteSummary summary_;
};

}  // namespace

double WriteSummary::MegapixelsPerSecond() const {
  return pictures_s > 0 ? static_cast<double>(pixels) * 1e-6 / pictures_s : 0.0;
}

Result<WriteSummary> WriteSession(const Experiment& experiment, const Truth& truth, const fs::path& folder,
                                  const WriteOptions& options, const FilesProgress& progress) {
  RIGCAL_TRY(MakeFolders(experiment, folder));
  RIGCAL_ASSIGN(const WriteSummary summary, Recorder(experiment, folder, options, progress).Run());
  RIGCAL_TRY(Write(folder / "truth.yaml", WriteTruth(truth)));
  RIGCAL_TRY(Write(folder / "session.yaml", SessionYaml(experiment)));
  return summary;
}

}  // namespace rigcal::sim
