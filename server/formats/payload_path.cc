#include "server/formats/payload_path.h"

#include <algorithm>
#include <array>

#include "server/base/text.h"

namespace rigcal::formats {
namespace {

constexpr std::array<std::string_view, 3> kPictureSuffixes = {"png", "jpg", "jpeg"};
constexpr const char* kCure = "Payloads are <sensor>/<capture>.png, .jpg or .jpeg (docs/session-format.md).";

char Lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

}  // namespace

std::string SuffixOf(std::string_view path) {
  const std::size_t dot = path.rfind('.');
  const std::size_t slash = path.rfind('/');
  if (dot == std::string_view::npos || (slash != std::string_view::npos && dot < slash)) return {};
  std::string suffix(path.substr(dot + 1));
  std::transform(suffix.begin(), suffix.end(), suffix.begin(), Lower);
  return suffix;
}

Result<Payload> PayloadAt(std::string_view path) {
  const auto bad = [&](const std::string& why) {
    return Fail(ErrorCode::kInvalidInput, "file " + Quoted(path) + ": " + why, kCure);
  };
  const std::size_t slash = path.find('/');
  if (slash == std::string_view::npos || path.find('/', slash + 1) != std::string_view::npos)
    return bad("is not in a sensor's folder");
  const std::string suffix = SuffixOf(path);
  if (std::find(kPictureSuffixes.begin(), kPictureSuffixes.end(), suffix) == kPictureSuffixes.end())
    return bad("has no suffix that is known here");
  auto sensor = SensorId::Parse(path.substr(0, slash));
  if (!sensor) return bad(sensor.error().what);
  auto capture = CaptureId::Parse(path.substr(slash + 1, path.size() - slash - suffix.size() - 2));
  if (!capture) return bad(capture.error().what);
  Payload payload;
  payload.path = path;
  payload.sensor = *std::move(sensor);
  payload.capture = *std::move(capture);
  return payload;
}

}  // namespace rigcal::formats
