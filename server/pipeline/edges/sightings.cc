#include "server/pipeline/edges/sightings.h"

#include <algorithm>
#include <optional>
#include <span>

#include "server/base/process/parallel_for.h"
#include "server/detect/board.h"
#include "server/detect/clouds/cloud_board.h"
#include "server/formats/clouds/cloud.h"
#include "server/formats/clouds/cloud_oddities.h"
#include "server/formats/sessions/payload_path.h"
#include "server/metrics/noted.h"
#include "server/pipeline/edges/decoding.h"
#include "server/pipeline/edges/lost_payloads.h"
#include "storage/files/blobs.h"

namespace rigcal::pipeline {
namespace {

template <typename Stored>
struct Found {
  const Payload* payload = nullptr;
  Stored stored;
  bool fresh = false;  // detected now, not yet in the store
  Status status;
};

// How one kind of sensor is searched: the key of its detector, and what finds, loads and keeps.
template <typename Stored>
struct Search {
  std::string key;
  Result<std::optional<Stored>> (*load)(storage::Store&, const Digest&, const std::string&);
  Status (*append)(storage::Store&, const Digest&, const std::string&, const Stored&);
  Needed (*needed)(const storage::Blobs&, const Payload&, const Target&);
  // The view, and its picture encoded.
  std::pair<Stored, std::string> (*detect)(const std::string& bytes, const Payload&, const Target&,
                                           const std::optional<CloudLayout>&);
  std::optional<CloudLayout> layout;  // of the sensor's .bin files, where it is given
};

// A cloud is what its suffix and its layout say: the same bytes under others are another cloud.
template <typename Stored>
std::string KeyOf(const Search<Stored>& search, const Payload& payload) {
  if constexpr (std::is_same_v<Stored, storage::StoredView>) return search.key;
  const std::string suffix(formats::SuffixOf(payload.path));
  if (suffix != "bin") return search.key + "/" + suffix;
  return search.key + "/bin of " + (search.layout ? TextOf(*search.layout) : "certainly " + TextOf(KittiLayout()));
}

// Detection is the costly part, so it is read from the cache where it can be.
template <typename Stored>
Result<std::vector<Found<Stored>>> LoadKnown(storage::Store& store, const Manifest& manifest, const SensorId& sensor,
                                             const Search<Stored>& search) {
  std::vector<Found<Stored>> all;
  for (const Payload& payload : manifest.payloads) {
    if (payload.sensor != sensor) continue;
    RIGCAL_ASSIGN(auto cached, search.load(store, payload.digest, KeyOf(search, payload)));
    Found<Stored> found;
    found.payload = &payload;
    // A picture of it that is gone or damaged is made again.
    found.fresh = !cached;
    if (cached && !cached->picture.empty()) {
      const Result<bool> is_kept = storage::FetchBlob(store.blobs(), cached->picture);
      if (!is_kept && is_kept.error().code != ErrorCode::kConflict) return Fail(is_kept.error());
      found.fresh = !is_kept || !*is_kept;
    }
    if (cached) found.stored = std::move(*cached);
    all.push_back(std::move(found));
  }
  return all;
}

bool IsReadable(const storage::StoredView& stored) { return stored.view.image_width_px > 0; }
bool IsReadable(const storage::StoredCloud& stored) { return stored.view.points > 0; }

// What was not found out costs this capture, not the robot, and is not stored: it is looked at again next time.
template <typename Stored>
void LeaveUnknown(const Error& error, const Target& target, Found<Stored>& found) {
  found.fresh = false;
  found.stored.view.target = target.id;
  found.stored.view.why_not = Sentence(error);
}

template <typename Stored>
Status DetectLoaded(const storage::Blobs& blobs, const Target& target, const Search<Stored>& search,
                    Found<Stored>& found) {
  RIGCAL_ASSIGN(const std::string bytes, LoadPayload(blobs, *found.payload));
  auto [stored, picture] = search.detect(bytes, *found.payload, target, search.layout);
  found.stored = std::move(stored);
  // Whatever could not be read may be readable under another name, limit or amount of memory: it is looked at again.
  found.fresh = IsReadable(found.stored);
  if (picture.empty()) return {};
  // Stored at once, so that memory does not grow with the number of captures.
  RIGCAL_ASSIGN(found.stored.picture, storage::AppendBlob(blobs, picture));
  return {};
}

template <typename Stored>
Status DetectFresh(const storage::Blobs& blobs, const Target& target, const Search<Stored>& search,
                   Found<Stored>& found) {
  const auto is_there = storage::FetchBlob(blobs, found.payload->digest);
  if (!is_there && is_there.error().code == ErrorCode::kUnreachable) return Fail(is_there.error());
  const auto share = TakeMemory(search.needed(blobs, *found.payload, target));
  if (!share) {
    LeaveUnknown(share.error(), target, found);
    return {};
  }
  Status status;
  RunApart([&] { status = DetectLoaded(blobs, target, search, found); });
  return status;
}

template <typename Stored>
Status DetectAll(const storage::Blobs& blobs, const Target& target, const Search<Stored>& search,
                 std::vector<Found<Stored>>& all) {
  metrics::TimedStage timed(metrics::Stage::kDetect);
  if (std::none_of(all.begin(), all.end(), [](const Found<Stored>& found) { return found.fresh; })) timed.Leave();
  ParallelFor(all.size(), [&](std::size_t i) {
    if (all[i].fresh) all[i].status = DetectFresh(blobs, target, search, all[i]);
  });
  for (const Found<Stored>& found : all) RIGCAL_TRY(found.status);
  timed.Done();
  return {};
}

template <typename Stored>
Result<Sightings<Stored>> SearchAll(storage::Store& store, const Manifest& manifest, const SensorId& sensor,
                                    const Target& target, const Search<Stored>& search) {
  RIGCAL_ASSIGN(std::vector<Found<Stored>> all, LoadKnown(store, manifest, sensor, search));
  RIGCAL_TRY(DetectAll(store.blobs(), target, search, all));
  RIGCAL_TRY(store.Write([&]() -> Status {
    for (const Found<Stored>& found : all)
      if (found.fresh)
        RIGCAL_TRY(search.append(store, found.payload->digest, KeyOf(search, *found.payload), found.stored));
    return {};
  }));
  Sightings<Stored> sightings;
  for (Found<Stored>& found : all) sightings[found.payload->capture] = std::move(found.stored);
  return sightings;
}

std::pair<storage::StoredView, std::string> DetectPicture(const std::string& bytes, const Payload&,
                                                          const Target& target, const std::optional<CloudLayout>&) {
  AnnotatedView found = detect::Detect(std::as_bytes(std::span(bytes)), target);
  return {{std::move(found.view), {}}, std::move(found.picture)};
}

std::pair<storage::StoredCloud, std::string> DetectCloud(const std::string& bytes, const Payload& payload,
                                                         const Target& target,
                                                         const std::optional<CloudLayout>& layout) {
  const auto cloud =
      formats::ReadCloud(std::as_bytes(std::span(bytes)), formats::SuffixOf(payload.path), payload.path, layout);
  if (!cloud) {
    storage::StoredCloud unreadable;
    unreadable.view.target = target.id;
    unreadable.view.why_not = Sentence(cloud.error());
    return {std::move(unreadable), {}};
  }
  AnnotatedCloud found = detect::DetectPlate(*cloud, target);
  found.view.note = formats::OdditiesOf(*cloud);
  return {{std::move(found.view), {}}, std::move(found.picture)};
}

}  // namespace

Result<Sightings<storage::StoredView>> DetectInImages(storage::Store& store, const Manifest& manifest,
                                                      const SensorId& camera, const Target& target) {
  return SearchAll<storage::StoredView>(
      store, manifest, camera, target,
      {detect::DetectorKey(target), storage::LoadView, storage::AppendView, ToSearchPicture, DetectPicture, {}});
}

Result<Sightings<storage::StoredCloud>> DetectInClouds(storage::Store& store, const Manifest& manifest,
                                                       const SensorId& lidar, const Target& target) {
  return SearchAll<storage::StoredCloud>(store, manifest, lidar, target,
                                         {detect::CloudDetectorKey(target), storage::LoadCloud, storage::AppendCloud,
                                          ToSearchCloud, DetectCloud, LayoutOf(manifest.header, lidar)});
}

std::size_t CountFound(const Sightings<storage::StoredView>& views) {
  return static_cast<std::size_t>(
      std::count_if(views.begin(), views.end(), [](const auto& item) { return item.second.view.found; }));
}

std::string EvidenceTitle(const SensorId& sensor, const CaptureId& capture, const std::string& found) {
  return sensor.str() + " / " + capture.str() + ": " + found;
}

void OddClouds::Add(const SensorId& lidar, const CaptureId& capture, const std::string& what) {
  if (!what.empty()) odd_[lidar].emplace(capture, what);
}

std::vector<Diagnosis> OddClouds::Notes() const {
  std::vector<Diagnosis> notes;
  for (const auto& [lidar, captures] : odd_) {
    const auto& [capture, what] = *captures.begin();
    const std::size_t count = captures.size();
    notes.push_back(
        {"odd_cloud",
         (count == 1 ? "Cloud " : std::to_string(count) + " clouds of " + lidar.str() + " are odd, first ") +
             lidar.str() + "/" + capture.str() + ": " + what + ".",
         "Look at it in a viewer; clouds are in metres, and of a .bin session.yaml's fields and point_type "
         "say what it holds."});
  }
  return notes;
}

}  // namespace rigcal::pipeline
