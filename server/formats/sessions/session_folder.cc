#include "server/formats/sessions/session_folder.h"

#include <algorithm>
#include <mutex>
#include <set>

#include "server/base/digests/sha256.h"
#include "server/base/files/durable_file.h"
#include "server/base/limits.h"
#include "server/base/process/parallel_for.h"
#include "server/base/text.h"
#include "server/formats/json/nearest.h"
#include "server/formats/sessions/folder_listing.h"
#include "server/formats/sessions/payload_kind.h"
#include "server/formats/sessions/payload_path.h"
#include "server/formats/sessions/refusals.h"
#include "server/formats/sessions/session_contents.h"

namespace rigcal::formats {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSessionYaml = "session.yaml";
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
                          const Refusals& refusals, std::vector<Payload>& payloads) {
  if (const Status known = CheckSensorFolder(entry, header); !known) return refusals.Take(known.error());
  const auto files = ListFolder(folder / entry.name, folder);
  if (!files) return refusals.Take(files.error());
  for (const ListedEntry& file : *files) {
    Result<Payload> payload = PayloadOf(file, folder, entry.name);
    if (payload)
      payloads.push_back(*std::move(payload));
    else
      RIGCAL_TRY(refusals.Take(std::move(payload).error()));
  }
  return {};
}

Status KeepOneFilePerCapture(const Refusals& refusals, std::vector<Payload>& payloads) {
  std::set<std::pair<SensorId, CaptureId>> seen;
  std::vector<Status> outcomes;
  for (const Payload& payload : payloads) {
    const bool is_first = seen.emplace(payload.sensor, payload.capture).second;
    outcomes.push_back(is_first ? Status()
                                : Fail(ErrorCode::kInvalidInput,
                                       "file " + Quoted(payload.path) + ": sensor '" + payload.sensor.str() +
                                           "' has another file of capture '" + payload.capture.str() + "'",
                                       "Keep one of the two."));
  }
  return KeepGood(outcomes, refusals, payloads);
}

// Everything that can be refused without reading the pictures.
Result<std::vector<Payload>> ListPayloads(const fs::path& folder, const SessionHeader& header,
                                          const Refusals& refusals) {
  RIGCAL_ASSIGN(const std::vector<ListedEntry> entries, ListFolder(folder, folder));
  std::vector<Payload> payloads;
  for (const ListedEntry& entry : entries) {
    if (entry.name == kSessionYaml || entry.name == kTruthYaml) continue;
    if (entry.kind == ListedEntry::Kind::kFolder)
      RIGCAL_TRY(AppendSensorFolder(folder, entry, header, refusals, payloads));
    else
      RIGCAL_TRY(refusals.Take({ErrorCode::kInvalidInput,
                                "file " + Quoted(entry.name) + ": it does not belong to a session", kIgnoredHint}));
  }
  if (payloads.empty() && !refusals.Any())
    RIGCAL_TRY(
        refusals.Take({ErrorCode::kInvalidInput, "session folder " + Quoted(folder.string()) + ": it has no captures",
                       "Put the pictures in <sensor>/<capture>.png or .jpg beside session.yaml."}));
  std::sort(payloads.begin(), payloads.end(), [](const Payload& a, const Payload& b) { return a.path < b.path; });
  RIGCAL_TRY(KeepOneFilePerCapture(refusals, payloads));
  return payloads;
}

Status HashPayloads(const fs::path& folder, const Progress& progress, const Refusals& refusals,
                    std::vector<Payload>& payloads) {
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
  return KeepGood(outcomes, refusals, payloads);
}

Status CheckManifest(const Refusals& refusals, Manifest& manifest) {
  std::vector<Status> outcomes;
  for (const Payload& payload : manifest.payloads) outcomes.push_back(Validate(payload, manifest.header));
  RIGCAL_TRY(KeepGood(outcomes, refusals, manifest.payloads));
  if (manifest.payloads.empty()) return {};
  const Status valid = Validate(manifest);
  return valid ? Status() : refusals.Take(valid.error());
}

Result<Manifest> ReadFolder(const fs::path& folder, const Progress& progress, const Refusals& refusals) {
  RIGCAL_ASSIGN(const std::vector<ListedEntry> entries, ListFolder(folder, folder));
  const auto is_session_yaml = [](const ListedEntry& entry) { return entry.name == kSessionYaml; };
  if (std::none_of(entries.begin(), entries.end(), is_session_yaml))
    return Fail(ErrorCode::kNotFound, "session folder " + Quoted(folder.string()) + ": it has no session.yaml",
                "Write one; docs/session-format.md has a complete example.");
  RIGCAL_ASSIGN(const std::string text, ReadFile(folder / kSessionYaml, limits::kSessionYamlBytesMax));
  Manifest manifest;
  RIGCAL_ASSIGN(manifest.header, ReadSessionYaml(text, kSessionYaml));
  RIGCAL_ASSIGN(manifest.payloads, ListPayloads(folder, manifest.header, refusals));
  RIGCAL_TRY(HashPayloads(folder, progress, refusals, manifest.payloads));
  RIGCAL_TRY(CheckManifest(refusals, manifest));
  RIGCAL_TRY(CheckContents(folder, refusals, manifest));
  return manifest;
}

}  // namespace

Result<Manifest> ReadSessionFolder(const fs::path& folder, const Progress& progress) {
  return ReadFolder(folder, progress, Refusals(nullptr));
}

Result<SessionSurvey> SurveySessionFolder(const fs::path& folder, const Progress& progress) {
  SessionSurvey survey;
  RIGCAL_ASSIGN(survey.manifest, ReadFolder(folder, progress, Refusals(&survey.refusals)));
  return survey;
}

}  // namespace rigcal::formats
