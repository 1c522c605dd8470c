// Conditional, encoded and partial requests: If-None-Match, Accept-Encoding, Range (RFC 9110). Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace rigcal::http {

// Whether one of the tags of an If-None-Match header is `etag` (weak comparison), or the header is "*".
[[nodiscard]] bool MatchesTag(std::string_view if_none_match, const std::string& etag);

// Whether an Accept-Encoding header takes gzip: by name, or as "*" where gzip is not named; not with q=0.
[[nodiscard]] bool AcceptsGzip(std::string_view accept_encoding);

struct ByteRange {
  std::int64_t first = 0, last = 0;
};  // both included
enum class RangeKind { kWhole, kPart, kUnsatisfiable };
struct RangeAnswer {
  RangeKind kind = RangeKind::kWhole;
  ByteRange range;
};
// One range of a file of `size_bytes`: "bytes=0-99", "bytes=100-", "bytes=-100". Several ranges, other units and what
// cannot be read are answered with the whole file, as the standard allows.
[[nodiscard]] RangeAnswer ParseRange(std::string_view header, std::int64_t size_bytes);

}  // namespace rigcal::http
