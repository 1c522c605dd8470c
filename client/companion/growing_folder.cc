#include "client/companion/growing_folder.h"

#include <sys/stat.h>

#include <algorithm>

#include "client/check/look.h"
#include "server/base/files/durable_file.h"
#include "server/base/limits.h"
#include "server/base/process/out_of_memory.h"
#include "server/calib/core/capture_blocks.h"
#include "server/formats/sessions/folder_listing.h"
#include "server/formats/sessions/payload_path.h"
#include "server/formats/sessions/session_folder.h"

namespace rigcal::companion {
namespace {

namespace fs = std::filesystem;

bool HasCaptures(const Sensor& sensor) {
  return sensor.kind == SensorKind::kCamera || sensor.kind == SensorKind::kLidar;
}

check::PictureSeen LookAt(const fs::path& folder, const Payload& payload, const std::vector<const Target*>& targets) {
  const auto bytes = ReadFile(folder / payload.path, static_cast<std::size_t>(limits::kPayloadBytesMax));
  if (!bytes) return {payload.path, bytes.error().what + "; " + bytes.error().cure, 0, 0, {}};
  return check::LookAtPicture(std::as_bytes(std::span(*bytes)), payload.path, targets);
}

}  // namespace

GrowingFolder::Stamp GrowingFolder::StampOf(const struct stat& found) {
  const auto ns_of = [](const timespec& time) { return time.tv_sec * 1'000'000'000LL + time.tv_nsec; };
  return {found.st_size, ns_of(found.st_mtim), ns_of(found.st_ctim), found.st_ino};
}

Result<bool> GrowingFolder::ReadHeader() {
  const fs::path path = folder_ / "session.yaml";
  struct stat found = {};
  if (stat(path.c_str(), &found) != 0)
    return Fail(ErrorCode::kNotFound, "there is no session.yaml in " + folder_.string(),
                "Put it there first: it names the sensors and the boards (docs/session-format.md).");
  const Stamp stamp = StampOf(found);
  if (header_ && stamp == header_stamp_) return false;
  RIGCAL_ASSIGN(const std::string text, ReadFile(path, limits::kSessionYamlBytesMax));
  RIGCAL_ASSIGN(SessionHeader header, formats::ReadSessionYaml(text, "session.yaml"));
  header_stamp_ = stamp;
  StartAnew(std::move(header));
  return true;
}

void GrowingFolder::StartAnew(SessionHeader header) {
  header_ = std::move(header);
  listing_ = {};
  waiting_.clear();
  captured_ = {};
  captured_.header = *header_;
  changed_.clear();
  for (const Sensor& sensor : header_->sensors) {
    if (HasCaptures(sensor)) captured_.files[sensor.id];
    if (sensor.kind == SensorKind::kCamera) changed_.insert(sensor.id);
  }
}

void GrowingFolder::ListSensor(const Sensor& sensor, Listing& listing) const {
  std::error_code failed;
  if (!fs::is_directory(folder_ / sensor.id.str(), failed)) return;
  const auto entries = formats::ListFolder(folder_ / sensor.id.str(), folder_);
  if (!entries) return listing.refusals.push_back(Sentence(entries.error()));
  std::set<CaptureId> taken;
  for (const formats::ListedEntry& entry : *entries) {
    if (entry.kind != formats::ListedEntry::Kind::kFile || entry.size_bytes == 0) continue;
    if (listing.files.size() >= limits::kPayloadsPerSessionMax) return;
    auto payload = formats::PayloadAt(sensor.id.str() + "/" + entry.name);
    if (!payload) {
      listing.refusals.push_back(Sentence(payload.error()));
      continue;
    }
    if (!taken.insert(payload->capture).second) continue;  // a push says that there are two
    struct stat found = {};
    if (stat((folder_ / payload->path).c_str(), &found) != 0) continue;
    listing.files[payload->path] = StampOf(found);
    listing.payloads[payload->path] = *std::move(payload);
  }
}

GrowingFolder::Listing GrowingFolder::ListSensors() const {
  Listing listing;
  for (const Sensor& sensor : header_->sensors)
    if (HasCaptures(sensor)) ListSensor(sensor, listing);
  return listing;
}

void GrowingFolder::ForgetWhatWent(const Listing& listing) {
  for (const auto& [path, payload] : listing_.payloads) {
    if (listing.files.contains(path)) continue;
    captured_.files[payload.sensor].erase(payload.capture);
    if (captured_.pictures[payload.sensor].erase(payload.capture) > 0) changed_.insert(payload.sensor);
  }
}

Result<bool> GrowingFolder::List() {
  RIGCAL_ASSIGN(const bool is_new, ReadHeader());
  Listing listing = ListSensors();
  if (!is_new && listing.files == listing_.files && listing.refusals == listing_.refusals) return false;
  ForgetWhatWent(listing);
  waiting_.clear();
  for (const auto& [path, payload] : listing.payloads) {
    captured_.files[payload.sensor].insert(payload.capture);
    if (SensorOf(*header_, payload.sensor)->kind != SensorKind::kCamera) continue;
    const auto& seen = captured_.pictures[payload.sensor];
    const auto before = listing_.files.find(path);
    if (before == listing_.files.end() || before->second != listing.files[path] || !seen.contains(payload.capture))
      waiting_.push_back(path);
  }
  std::stable_sort(waiting_.begin(), waiting_.end(), [&](const std::string& x, const std::string& y) {
    return calib::TakenBefore()(listing.payloads[y].capture, listing.payloads[x].capture);
  });
  captured_.refusals = listing.refusals;
  listing_ = std::move(listing);
  return true;
}

void GrowingFolder::LookAtNext() {
  if (waiting_.empty()) return;
  const Payload payload = listing_.payloads.at(waiting_.back());
  waiting_.pop_back();
  const Sensor& sensor = *SensorOf(*header_, payload.sensor);
  captured_.pictures[sensor.id][payload.capture] = LookAt(folder_, payload, CommonTargets(*header_, sensor, sensor));
  changed_.insert(sensor.id);
}

Captured GrowingFolder::SoFar() {
  static const std::map<CaptureId, check::PictureSeen> kNone;
  for (const SensorId& camera : changed_) {
    const auto pictures = captured_.pictures.find(camera);
    captured_.cameras[camera] =
        FindCameraSoFar(*header_, *SensorOf(*header_, camera),
                        pictures == captured_.pictures.end() ? kNone : pictures->second, lenses_);
  }
  changed_.clear();
  captured_.is_looking = !waiting_.empty();
  return captured_;
}

}  // namespace rigcal::companion
