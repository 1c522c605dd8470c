#include "server/formats/sessions/session_contents.h"

#include <map>
#include <set>

#include "server/base/files/durable_file.h"
#include "server/base/limits.h"
#include "server/base/process/parallel_for.h"
#include "server/formats/clouds/bin_layout.h"
#include "server/formats/sessions/payload_path.h"
#include "server/formats/sessions/poses.h"

namespace rigcal::formats {
namespace {

namespace fs = std::filesystem;

constexpr const char *kTableSuffix = "csv", *kBinSuffix = "bin";

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

// Of trackers.
struct PoseTables {
  std::map<SensorId, std::string> texts;
  std::map<SensorId, PoseTable> tables;
};

Status AppendTable(const fs::path& folder, const SessionHeader& header, const Payload& payload, PoseTables& read) {
  if (SuffixOf(payload.path) != kTableSuffix) return {};
  const SensorKind kind = SensorOf(header, payload.sensor)->kind;
  RIGCAL_ASSIGN(std::string text, ReadFile(folder / payload.path, limits::kPoseTableBytesMax));
  RIGCAL_ASSIGN(PoseTable table, ReadPoses(text, kind, payload.path));
  if (kind != SensorKind::kTracker) return {};
  read.tables[payload.sensor] = std::move(table);
  read.texts[payload.sensor] = std::move(text);
  return {};
}

Status CheckTableCaptures(const PoseTables& read, const std::vector<Payload>& payloads, const Payload& payload) {
  const auto text = read.texts.find(payload.sensor);
  if (text == read.texts.end()) return {};
  RIGCAL_TRY(ReadPosesOf(OtherCaptures(read.tables, payloads, payload.sensor), text->second, payload.path));
  return {};
}

// A picture that is bad costs one capture; a table of poses is all that its sensor has, so it is read before it is
// sent.
Status CheckPoseTables(const fs::path& folder, const Refusals& refusals, Manifest& manifest) {
  PoseTables read;
  std::vector<Status> outcomes;
  for (const Payload& payload : manifest.payloads)
    outcomes.push_back(AppendTable(folder, manifest.header, payload, read));
  RIGCAL_TRY(KeepGood(outcomes, refusals, manifest.payloads));
  if (refusals.Any()) return {};  // the captures of refused files are not known
  outcomes.clear();
  for (const Payload& payload : manifest.payloads)
    outcomes.push_back(CheckTableCaptures(read, manifest.payloads, payload));
  return KeepGood(outcomes, refusals, manifest.payloads);
}

// Nothing in a .bin says what it holds, and a technician can say it.
Status CheckBins(const fs::path& folder, const Refusals& refusals, Manifest& manifest) {
  std::vector<Status> outcomes(manifest.payloads.size());
  ParallelFor(manifest.payloads.size(), [&](std::size_t i) {
    const Payload& payload = manifest.payloads[i];
    if (SuffixOf(payload.path) != kBinSuffix) return;
    const auto bytes = ReadFile(folder / payload.path, static_cast<std::size_t>(limits::kPayloadBytesMax));
    outcomes[i] = bytes ? CheckBinLayout(*bytes, LayoutOf(manifest.header, payload.sensor), payload.path)
                        : Status(Fail(bytes.error()));
  });
  return KeepGood(outcomes, refusals, manifest.payloads);
}

}  // namespace

std::map<SensorId, PoseTable> ReadTrackers(const fs::path& folder, const Manifest& manifest) {
  std::map<SensorId, PoseTable> tables;
  for (const Payload& payload : manifest.payloads) {
    const Sensor* sensor = SensorOf(manifest.header, payload.sensor);
    if (sensor == nullptr || sensor->kind != SensorKind::kTracker) continue;
    const auto text = ReadFile(folder / payload.path, limits::kPoseTableBytesMax);
    auto table = text ? ReadPoses(*text, sensor->kind, payload.path) : Fail(text.error());
    if (table) tables[payload.sensor] = *std::move(table);
  }
  return tables;
}

Status CheckContents(const fs::path& folder, const Refusals& refusals, Manifest& manifest) {
  RIGCAL_TRY(CheckPoseTables(folder, refusals, manifest));
  return CheckBins(folder, refusals, manifest);
}

}  // namespace rigcal::formats
