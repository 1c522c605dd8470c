#include "server/pipeline/edges/lost_payloads.h"

#include <algorithm>

#include "server/base/process/parallel_for.h"
#include "server/model/edges/past.h"

namespace rigcal::pipeline {
namespace {

constexpr std::size_t kLostNamedMax = 5;

// "left/01.png (damaged), left/02.png (missing) and 3 more".
std::string FilesOf(const std::vector<LostFile>& lost) {
  std::string names;
  for (std::size_t i = 0; i < std::min(lost.size(), kLostNamedMax); ++i)
    names += (i > 0 ? ", " : "") + lost[i].payload->path +
             (lost[i].state == storage::BlobState::kMissing ? " (missing)" : " (damaged)");
  return lost.size() <= kLostNamedMax ? names : names + " and " + std::to_string(lost.size() - kLostNamedMax) + " more";
}

std::string SensorsOf(const std::vector<LostFile>& lost) {
  std::vector<std::string> sensors;
  for (const LostFile& file : lost) sensors.push_back(file.payload->sensor.str());
  std::sort(sensors.begin(), sensors.end());
  sensors.erase(std::unique(sensors.begin(), sensors.end()), sensors.end());
  std::string names;
  for (const std::string& sensor : sensors) names += (names.empty() ? "" : ", ") + sensor;
  return names;
}

}  // namespace

Result<std::string> LoadPayload(const storage::Blobs& blobs, const Payload& payload, std::size_t bytes_max) {
  auto bytes = storage::LoadBlob(blobs, payload.digest, bytes_max);
  const bool is_told = bytes || bytes.error().code == ErrorCode::kUnreachable;  // of which nothing follows for the file
  if (is_told || static_cast<std::size_t>(payload.size_bytes) > bytes_max) return bytes;
  return Fail(ErrorCode::kStorage, payload.path + ": " + bytes.error().what, "Push the session again.");
}

Result<std::vector<LostFile>> FindLost(const storage::Store& store, const std::vector<const Payload*>& payloads) {
  std::vector<LostFile> files;
  for (const Payload* payload : payloads) files.push_back({payload, {}});
  std::vector<Status> looked(files.size());
  ParallelFor(files.size(), [&](std::size_t i) {
    const auto state = storage::SetDamagedAside(store.blobs(), files[i].payload->digest);
    if (state) files[i].state = *state;
    if (!state) looked[i] = Fail(state.error());
  });
  for (const Status& one : looked) RIGCAL_TRY(one);
  std::erase_if(files, [](const LostFile& file) { return file.state == storage::BlobState::kGood; });
  return files;
}

Status AppendLost(storage::Store& store, const std::vector<LostFile>& lost, std::optional<std::int64_t> job_number,
                  Stamp now) {
  for (const LostFile& file : lost)
    RIGCAL_TRY(storage::AppendLost(store, file.payload->digest, file.state, job_number, now));
  return {};
}

Diagnosis TellLost(const RobotId& robot, const std::vector<LostFile>& lost) {
  return {std::string(kFileLostCode),
          "the server's disk has not kept what robot " + robot.str() + " pushed of " + SensorsOf(lost) + ": " +
              FilesOf(lost),
          "Push the session again: only these files are sent, and the pair is calibrated from them. Check the server's "
          "disk; damaged files are kept beside the others, with names ending in .damaged."};
}

}  // namespace rigcal::pipeline
