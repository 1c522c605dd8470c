#include "server/http/conditions.h"
#include "server/http/request_path.h"
#include "tests/fuzz/fuzz.h"

using namespace rigcal;

namespace {

bool HasHidden(const std::string& path) { return path.front() == '.' || path.find("/.") != std::string::npos; }

void CheckPath(std::string_view raw) {
  const auto path = http::NormalPath(raw);
  if (!fuzz::RequireGoodError(path)) return;
  fuzz::Require(!path->empty() && path->front() == '/' && !HasHidden(*path), "a path stays below the root", *path);
  fuzz::Require(path->find('\0') == std::string::npos, "a path has no end in its middle");
  if (const auto file = http::PublishedFile(*path))
    fuzz::Require(!HasHidden(*file), "a file stays below its folder", *file);
  (void)http::WithSlash(*path);
  (void)http::IsApi(*path);
}

void CheckRange(std::string_view header, std::int64_t size_bytes) {
  const http::RangeAnswer answer = http::ParseRange(header, size_bytes);
  if (answer.kind != http::RangeKind::kPart) return;
  fuzz::Require(answer.range.first >= 0 && answer.range.first <= answer.range.last && answer.range.last < size_bytes,
                "a range lies in its file");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = fuzz::TextOf(data, size);
  CheckPath(text);
  for (const std::int64_t size_bytes : {std::int64_t{0}, std::int64_t{1}, std::int64_t{1000}, INT64_MAX})
    CheckRange(text, size_bytes);
  (void)http::MatchesTag(text, "\"abc\"");
  return 0;
}
