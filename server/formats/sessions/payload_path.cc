#include "server/formats/sessions/payload_path.h"

#include <algorithm>

#include "server/base/text.h"

namespace rigcal::formats {
namespace {

constexpr const char* kPathCure =
    "Payloads are <sensor>/<capture>.png, .jpg or .jpeg of a camera, .pcd, .ply or .bin of a lidar, and "
    "<sensor>/poses.csv of a tracker or pose stream, in lower case.";

bool IsKnown(std::string_view suffix) {
  const auto is_of = [&](SensorKind kind) {
    const auto& suffixes = SuffixesOf(kind);
    return std::find(suffixes.begin(), suffixes.end(), suffix) != suffixes.end();
  };
  return is_of(SensorKind::kCamera) || is_of(SensorKind::kLidar) || is_of(SensorKind::kTracker);
}

}  // namespace

std::string_view SuffixOf(std::string_view path) {
  const std::size_t dot = path.rfind('.');
  if (dot == std::string_view::npos || path.find('/', dot) != std::string_view::npos) return {};
  return path.substr(dot + 1);
}

Result<Payload> PayloadAt(std::string_view path) {
  const auto bad = [&](const std::string& why, const std::string& cure = kPathCure) {
    return Fail(ErrorCode::kInvalidInput, "file " + Quoted(path) + ": " + why, cure);
  };
  const std::size_t slash = path.find('/');
  if (slash == std::string_view::npos || path.find('/', slash + 1) != std::string_view::npos)
    return bad("it is not in a sensor's folder");
  const std::string_view suffix = SuffixOf(path);
  if (!IsKnown(suffix)) return bad("its name does not end in .png, .jpg, .jpeg, .pcd, .ply, .bin or .csv");
  auto sensor = SensorId::Parse(path.substr(0, slash));
  if (!sensor) return bad(sensor.error().what, sensor.error().cure);
  auto capture = CaptureId::Parse(path.substr(slash + 1, path.size() - slash - suffix.size() - 2));
  if (!capture) return bad(capture.error().what, capture.error().cure);
  Payload payload;
  payload.path = path;
  payload.sensor = *std::move(sensor);
  payload.capture = *std::move(capture);
  return payload;
}

}  // namespace rigcal::formats
