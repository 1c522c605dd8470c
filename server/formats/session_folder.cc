#include "server/formats/session_folder.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <set>

#include "server/base/durable_file.h"
#include "server/base/limits.h"
#include "server/base/parallel_for.h"
#include "server/base/sha256.h"
#include "server/base/text.h"
#include "server/formats/bin_layout.h"
#include "server/formats/folder_listing.h"
#include "server/formats/nearest.h"
#include "server/formats/payload_kind.h"
#include "server/formats/payload_path.h"
#include "server/formats/poses.h"

namespace rigcal::formats {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSessionYaml = "session.yaml";
constexpr const char *kTableSuffix = "csv", *kBinSuffix = "bin";
constexpr const char* kTruthYaml = "truth.yaml";  // of a simulated session: not for those who calibrate it
constexpr const char* kIgnoredHint = "Move it out of the folder, or begin its name with a '.': such files are ignored.";

using Progress = std::function<void(std::int64_t, std::int64_t)>;

Status CheckSensorFolder(const ListedEntry& entry, const SessionHeader& header) {
  std::vector<std::string_view> sensors;
  for (const Sensor& sensor : header.sensors) sensors.push_back(sensor.id.str());
  if (std::find(sensors.begin(), sensors.end(), entry.name) != sensors.end()) return {};
  return Fail(
      ErrorCode::kInvalidInput,
      "folder " + Quoted(entry.name) + ": session.yaml has no sensor of this name; " + DidYouMean(entry.name, sensors),
      "Rename the folder or list the sensor in session.yaml.");
}

Result<Payload> PayloadOf(const ListedEntry& entry, const fs::path& folder, const std::string& sensor) {
  const std::string path = sensor + "/" + entry.name;
  const std::string title = "file " + Quoted(path) + ": ";
  if (entry.kind != ListedEntry::Kind::kFile)
    return Fail(ErrorCode::kInvalidInput, title + "it is not a file; a sensor's folder holds files only", kIgnoredHint);
  RIGCAL_ASSIGN(Payload payload, PayloadAt(path));
  payload.size_bytes = entry.size_bytes;
  if (payload.size_bytes < 1)
    return Fail(ErrorCode::kInvalidInput, title + "it is empty", "Record the capture again, or remove the file.");
  if (payload.size_bytes > limits::kPayloadBytesMax)
    return Fail(ErrorCode::kInvalidInput,
                title + "it has " + std::to_string(payload.size_bytes) + " bytes; the limit is " +
                    std::to_string(limits::kPayloadBytesMax),
                "Store the capture in a smaller file.");
  RIGCAL_TRY(CheckPayloadKind(folder / sensor / entry.name, path));
  return payload;
}

Status AppendSensorFolder(const fs::path& folder, const ListedEntry& entry, const SessionHeader& header,
                          std::vector<Payload>& payloads) {
  RIGCAL_TRY(CheckSensorFolder(entry, header));
  RIGCAL_ASSIGN(const std::vector<ListedEntry> files, ListFolder(folder / entry.name, folder));
  for (const ListedEntry& file : files) {
    RIGCAL_ASSIGN(Payload payload, PayloadOf(file, folder, entry.name));
    payloads.push_back(std::move(payload));
  }
  return {};
}

Status CheckOneFilePerCapture(const std::vector<Payload>& payloads) {
  std::set<std::pair<SensorId, CaptureId>> seen;
  for (const Payload& payload : payloads)
    if (!seen.emplace(payload.sensor, payload.capture).second)
      return Fail(ErrorCode::kInvalidInput,
                  "file " + Quoted(payload.path) + ": sensor '" + payload.sensor.str() +
                      "' has another file of capture '" + payload.capture.str() + "'",
                  "Keep one of the two.");
  return {};
}

// Everything that can be refused without reading the pictures.
Result<std::vector<Payload>> ListPayloads(const fs::path& folder, const SessionHeader& header) {
  RIGCAL_ASSIGN(const std::vector<ListedEntry> entries, ListFolder(folder, folder));
  std::vector<Payload> payloads;
  for (const ListedEntry& entry : entries) {
    if (entry.name == kSessionYaml || entry.name == kTruthYaml) continue;
    if (entry.kind != ListedEntry::Kind::kFolder)
      return Fail(ErrorCode::kInvalidInput, "file " + Quoted(entry.name) + ": it does not belong to a session",
                  kIgnoredHint);
    RIGCAL_TRY(AppendSensorFolder(folder, entry, header, payloads));
  }
  if (payloads.empty())
    return Fail(ErrorCode::kInvalidInput, "session folder " + Quoted(folder.string()) + ": it has no captures",
                "Put the pictures in <sensor>/<capture>.png or .jpg beside session.yaml.");
  std::sort(payloads.begin(), payloads.end(), [](const Payload& a, const Payload& b) { return a.path < b.path; });
  RIGCAL_TRY(CheckOneFilePerCapture(payloads));
  return payloads;
}

// The captures that sensors other than `tracker` have: names of files, and of rows of other trackers.
std::set<CaptureId> OtherCaptures(const std::map<SensorId, PoseTable>& tables, const std::vector<Payload>& payloads,
                                  const SensorId& tracker) {
  std::set<CaptureId> captures;
  for (const Payload& payload : payloads)
    if (SuffixOf(payload.path) != kTableSuffix) captures.insert(payload.capture);
  for (const auto& [sensor, table] : tables)
    if (sensor != tracker)
      for (const TimedPose& pose : table) captures.insert(pose.capture);
  return captures;
}

// A picture that is bad costs one capture; a table of poses is all that its sensor has, so it is read before it is
// sent.
Status CheckPoseTables(const fs::path& folder, const Manifest& manifest) {
  std::map<SensorId, std::string> texts;
  std::map<SensorId, PoseTable> tables;
  for (const Payload& payload : manifest.payloads) {
    if (SuffixOf(payload.path) != kTableSuffix) continue;
    const auto sensor = std::find_if(manifest.header.sensors.begin(), manifest.header.sensors.end(),
                                     [&](const Sensor& s) { return s.id == payload.sensor; });
    RIGCAL_ASSIGN(std::string text, ReadFile(folder / payload.path, limits::kPoseTableBytesMax));
    RIGCAL_ASSIGN(PoseTable table, ReadPoses(text, sensor->kind, payload.path));
    if (sensor->kind != SensorKind::kTracker) continue;
    tables[payload.sensor] = std::move(table);
    texts[payload.sensor] = std::move(text);
  }
  for (const auto& [sensor, text] : texts)
    RIGCAL_TRY(ReadPosesOf(OtherCaptures(tables, manifest.payloads, sensor), text,
                           sensor.str() + "/" + std::string(kPoseTableStem) + "." + kTableSuffix));
  return {};
}

// Nothing in a .bin says what it holds, and a technician can say it.
Status CheckBins(const fs::path& folder, const Manifest& manifest) {
  std::vector<Status> outcomes(manifest.payloads.size());
  ParallelFor(manifest.payloads.size(), [&](std::size_t i) {
    const Payload& payload = manifest.payloads[i];
    if (SuffixOf(payload.path) != kBinSuffix) return;
    const auto bytes = ReadFile(folder / payload.path, static_cast<std::size_t>(limits::kPayloadBytesMax));
    const auto sensor = std::find_if(manifest.header.sensors.begin(), manifest.header.sensors.end(),
                                     [&](const Sensor& s) { return s.id == payload.sensor; });
    outcomes[i] = bytes ? CheckBinLayout(*bytes, sensor->layout, payload.path) : Status(Fail(bytes.error()));
  });
  for (const Status& outcome : outcomes) RIGCAL_TRY(outcome);
  return {};
}

Status HashPayloads(const fs::path& folder, const Progress& progress, std::vector<Payload>& payloads) {
  std::int64_t bytes_in_all = 0, bytes_hashed = 0;
  for (const Payload& payload : payloads) bytes_in_all += payload.size_bytes;
  std::mutex mutex;
  std::vector<Status> outcomes(payloads.size());
  ParallelFor(payloads.size(), [&](std::size_t i) {
    Result<Digest> digest = Sha256OfFile(folder / payloads[i].path);
    if (digest)
      payloads[i].digest = *std::move(digest);
    else
      outcomes[i] = Fail(std::move(digest).error());
    const std::lock_guard lock(mutex);
    bytes_hashed += payloads[i].size_bytes;
    if (progress) progress(bytes_hashed, bytes_in_all);
  });
  for (const Status& outcome : outcomes) RIGCAL_TRY(outcome);
  return {};
}

}  // namespace

Result<Manifest> ReadSessionFolder(const fs::path& folder, const Progress& progress) {
  RIGCAL_ASSIGN(const std::vector<ListedEntry> entries, ListFolder(folder, folder));
  const auto is_session_yaml = [](const ListedEntry& entry) { return entry.name == kSessionYaml; };
  if (std::none_of(entries.begin(), entries.end(), is_session_yaml))
    return Fail(ErrorCode::kNotFound, "session folder " + Quoted(folder.string()) + ": it has no session.yaml",
                "Write one; docs/session-format.md has a complete example.");
  RIGCAL_ASSIGN(const std::string text, ReadFile(folder / kSessionYaml, limits::kSessionYamlBytesMax));
  Manifest manifest;
  RIGCAL_ASSIGN(manifest.header, ReadSessionYaml(text, kSessionYaml));
  RIGCAL_ASSIGN(manifest.payloads, ListPayloads(folder, manifest.header));
  RIGCAL_TRY(HashPayloads(folder, progress, manifest.payloads));
  RIGCAL_TRY(Validate(manifest));
  RIGCAL_TRY(CheckPoseTables(folder, manifest));
  RIGCAL_TRY(CheckBins(folder, manifest));
  return manifest;
}

}  // namespace rigcal::formats
