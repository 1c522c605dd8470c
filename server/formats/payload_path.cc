#include "server/formats/payload_path.h"

#include <algorithm>
#include <array>

#include "server/base/text.h"

namespace rigcal::formats {
namespace {

constexpr std::array<std::string_view, 3> kPictureSuffixes = {"png", "jpg", "jpeg"};
constexpr const char* kCure = "Payloads are <sensor>/<capture>.png, .jpg or .jpeg, in lower case.";

}  // namespace

std::string_view SuffixOf(std::string_view path) {
  const std::size_t dot = path.rfind('.');
  if (dot == std::string_view::npos || path.find('/', dot) != std::string_view::npos) return {};
  return path.substr(dot + 1);
}

Result<Payload> PayloadAt(std::string_view path) {
  const auto bad = [&](const std::string& why) {
    return Fail(ErrorCode::kInvalidInput, "file " + Quoted(path) + ": " + why, kCure);
  };
  const std::size_t slash = path.find('/');
  if (slash == std::string_view::npos || path.find('/', slash + 1) != std::string_view::npos)
    return bad("it is not in a sensor's folder");
  const std::string_view suffix = SuffixOf(path);
  if (std::find(kPictureSuffixes.begin(), kPictureSuffixes.end(), suffix) == kPictureSuffixes.end())
    return bad("its name does not end in .png, .jpg or .jpeg");
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
