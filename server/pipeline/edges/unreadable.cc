#include "server/pipeline/edges/unreadable.h"

#include <algorithm>
#include <set>
#include <span>

#include "server/detect/pictures/image_header.h"
#include "server/pipeline/edges/decoding.h"
#include "server/pipeline/edges/sightings.h"
#include "storage/files/blobs.h"

namespace rigcal::pipeline {
namespace {

constexpr std::size_t kLookedAtMax = 48;
constexpr std::size_t kLookedAtBytesMax = 64u << 20;

// `is_away`: it is in a bucket that cannot be asked, as are the others.
std::string WhyNot(storage::Store& store, const Manifest& manifest, const Payload& payload, bool& is_away) {
  for (const Target& target : manifest.header.targets)
    if (const auto large = TooLarge(ToSearchPicture(store.blobs(), payload, target))) return large->what;
  const auto bytes = storage::LoadBlob(store.blobs(), payload.digest, kLookedAtBytesMax);
  if (!bytes && bytes.error().code == ErrorCode::kInvalidInput) return bytes.error().what;
  if (!bytes && bytes.error().code == ErrorCode::kUnreachable) {
    is_away = true;
    return bytes.error().what;
  }
  if (!bytes) return "the server's disk has not kept it: push the session again";
  const auto encoded = std::as_bytes(std::span(*bytes));
  if (const auto size = detect::ReadImageSize(encoded); !size) return size.error().what;
  return detect::IsCutOff(encoded) ? "the picture is cut off" : "";
}

}  // namespace

Unreadable FindUnreadable(storage::Store& store, const Manifest& manifest, const std::vector<Edge>& edges) {
  std::set<std::pair<CaptureId, SensorId>> shown;
  for (const Edge& edge : edges)
    for (const Evidence& evidence : edge.evidence) shown.emplace(evidence.capture, evidence.sensor);
  Unreadable unreadable;
  std::size_t looked_at = 0;
  bool is_away = false;
  for (const Payload& payload : manifest.payloads) {
    const Sensor* sensor = SensorOf(manifest.header, payload.sensor);
    const std::pair place{payload.capture, payload.sensor};
    if (!sensor || sensor->kind != SensorKind::kCamera || shown.contains(place)) continue;
    unreadable.all_looked_at = looked_at++ < kLookedAtMax && !is_away;
    if (!unreadable.all_looked_at) break;
    if (std::string why = WhyNot(store, manifest, payload, is_away); !why.empty())
      unreadable.why[place] = std::move(why);
  }
  return unreadable;
}

}  // namespace rigcal::pipeline
