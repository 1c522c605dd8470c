#include "server/http/request_path.h"

#include <civetweb.h>

#include <algorithm>
#include <vector>

#include "server/base/ids.h"

namespace rigcal::http {
namespace {

// Whether a certificate still holds is decided after its report was drawn.
constexpr const char* kMadeWhenAsked = "certificate.html";

bool IsHex(char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F'); }

tl::unexpected<Error> Refused() {
  return Fail(ErrorCode::kInvalidInput, "this address is not understood", "Check it for typing errors, or start at /.");
}

bool IsForbidden(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f || c == '\\'; }

std::vector<std::string> Segments(const std::string& path) {
  std::vector<std::string> segments;
  for (std::size_t start = 0; start < path.size();) {
    const std::size_t end = std::min(path.find('/', start), path.size());
    if (end > start) segments.push_back(path.substr(start, end - start));
    start = end + 1;
  }
  return segments;
}

bool IsNumber(const std::string& text) {
  return !text.empty() && text.size() <= 9 && text.front() != '0' &&
         text.find_first_not_of("0123456789") == std::string::npos;
}

bool IsRevision(const std::vector<std::string>& segments) {
  return segments.size() >= 4 && segments[0] == "robots" && segments[2] == "revisions" && IsNumber(segments[3]) &&
         RobotId::Parse(segments[1]).has_value();
}

}  // namespace

std::optional<std::string> PercentDecoded(std::string_view raw, Plus plus) {
  for (std::size_t i = raw.find('%'); i != std::string_view::npos; i = raw.find('%', i + 1))
    if (i + 2 >= raw.size() || !IsHex(raw[i + 1]) || !IsHex(raw[i + 2])) return std::nullopt;
  std::string text(raw.size() + 1, '\0');
  const int size = mg_url_decode(raw.data(), static_cast<int>(raw.size()), text.data(), static_cast<int>(text.size()),
                                 plus == Plus::kIsSpace ? 1 : 0);
  if (size < 0) return std::nullopt;
  text.resize(static_cast<std::size_t>(size));
  return text;
}

Result<std::string> NormalPath(std::string_view raw) {
  if (raw.empty() || raw.front() != '/') return Refused();
  const std::optional<std::string> decoded = PercentDecoded(raw, Plus::kIsPlus);
  if (!decoded || decoded->empty() || std::any_of(decoded->begin(), decoded->end(), IsForbidden)) return Refused();
  std::string path;
  for (const std::string& segment : Segments(*decoded)) {
    if (segment.front() == '.') return Refused();
    path += "/" + segment;
  }
  return decoded->back() == '/' ? path + "/" : path;
}

std::optional<std::string> PublishedFile(const std::string& path) {
  const auto segments = Segments(path);
  if (!IsRevision(segments) || (segments.size() == 5 && segments[4] == kMadeWhenAsked)) return std::nullopt;
  std::string file = segments[1] + "/" + segments[3];
  for (std::size_t i = 4; i < segments.size(); ++i) file += "/" + segments[i];
  return path.back() == '/' ? file + "/index.html" : file;
}

std::optional<std::string> WithSlash(const std::string& path) {
  if (path.back() == '/') return std::nullopt;
  const auto segments = Segments(path);
  const bool is_robot = segments.size() == 2 && segments[0] == "robots" && RobotId::Parse(segments[1]).has_value();
  const bool is_experiment = !segments.empty() && segments.size() <= 2 && segments[0] == "experiments" &&
                             (segments.size() == 1 || CheckName("experiment", segments[1]).has_value());
  const bool is_model = !segments.empty() && segments.size() <= 2 && segments[0] == "models" &&
                        (segments.size() == 1 || CheckName("rig model", segments[1]).has_value());
  const bool is_boards = segments.size() == 1 && segments[0] == "boards";
  if (!is_robot && !is_experiment && !is_model && !is_boards && !(segments.size() == 4 && IsRevision(segments)))
    return std::nullopt;
  return path + "/";
}

std::string RobotAbove(const std::string& path) {
  const auto segments = Segments(path);
  const bool below = segments.size() > 2 && segments[0] == "robots" && RobotId::Parse(segments[1]).has_value();
  return below ? segments[1] : "";
}

bool IsApi(const std::string& path) {
  return path == "/api" || path.rfind("/api/", 0) == 0 || path == "/healthz" || path == "/readyz";
}

}  // namespace rigcal::http
