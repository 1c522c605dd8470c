#include "server/pipeline/unreadable.h"

#include <algorithm>
#include <set>
#include <span>

#include "server/detect/image_header.h"
#include "server/pipeline/sightings.h"
#include "storage/blobs.h"

namespace rigcal::pipeline {
namespace {

constexpr std::size_t kLookedAtMax = 48;
constexpr std::size_t kPictureBytesMax = 64u << 20;

std::string WhyNot(storage::Store& store, const Payload& payload) {
  const auto bytes = storage::LoadBlob(store.BlobFolder(), payload.digest, kPictureBytesMax);
  if (!bytes) return bytes.error().what;
  const auto encoded = std::as_bytes(std::span(*bytes));
  if (const auto size = detect::ReadImageSize(encoded); !size) return size.error().what;
  return detect::IsCutOff(encoded) ? "the picture is cut off" : "";
}

}  // namespace

std::map<std::pair<CaptureId, SensorId>, std::string> WhyUnreadable(storage::Store& store, const Manifest& manifest,
                                                                    const std::vector<Edge>& edges) {
  std::set<std::pair<CaptureId, SensorId>> shown;
  for (const Edge& edge : edges)
    for (const Evidence& evidence : edge.evidence) shown.emplace(evidence.capture, evidence.sensor);
  std::map<std::pair<CaptureId, SensorId>, std::string> why_not;
  std::size_t looked_at = 0;
  for (const Payload& payload : manifest.payloads) {
    const Sensor* sensor = SensorOf(manifest.header, payload.sensor);
    const std::pair place{payload.capture, payload.sensor};
    if (!sensor || sensor->kind != SensorKind::kCamera || shown.contains(place)) continue;
    if (looked_at++ == kLookedAtMax) break;
    if (std::string why = WhyNot(store, payload); !why.empty()) why_not[place] = std::move(why);
  }
  return why_not;
}

}  // namespace rigcal::pipeline
