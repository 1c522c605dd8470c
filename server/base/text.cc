#include "server/base/text.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace rigcal {
namespace {

constexpr std::size_t kQuotedBytesMax = 80;

void AppendEscaped(std::string& out, char c) {
  constexpr std::string_view kHexDigits = "0123456789abcdef";
  const auto byte = static_cast<unsigned char>(c);
  if (byte >= 0x20 && byte < 0x7f && c != '"' && c != '\\') {
    out.push_back(c);
  } else if (c == '"' || c == '\\') {
    out.append({'\\', c});
  } else {
    out.append({'\\', 'x', kHexDigits[byte >> 4], kHexDigits[byte & 15]});
  }
}

// Bytes of the UTF-8 sequence that starts with `lead`; 0 if none can.
std::size_t SequenceLength(unsigned char lead) {
  if (lead < 0x80) return 1;
  if (lead >= 0xc2 && lead < 0xe0) return 2;
  if (lead >= 0xe0 && lead < 0xf0) return 3;
  return lead >= 0xf0 && lead < 0xf5 ? 4 : 0;
}

// The code point of a whole sequence; 0 if a continuation byte is missing.
std::uint32_t Decode(std::string_view sequence) {
  constexpr std::array<std::uint32_t, 5> kLeadMask = {0, 0x7f, 0x1f, 0x0f, 0x07};
  std::uint32_t point = static_cast<unsigned char>(sequence[0]) & kLeadMask.at(sequence.size());
  for (char c : sequence.substr(1)) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte & 0xc0) != 0x80) return 0;
    point = (point << 6) | (byte & 0x3f);
  }
  return point;
}

bool IsPrintable(std::uint32_t point, std::size_t length) {
  constexpr std::array<std::uint32_t, 5> kSmallest = {0, 0x20, 0x80, 0x800, 0x10000};
  const bool control = point >= 0x7f && point < 0xa0;
  const bool line_or_bidi = (point >= 0x2028 && point <= 0x202e) || (point >= 0x2066 && point <= 0x2069);
  const bool surrogate = point >= 0xd800 && point <= 0xdfff;
  return point >= kSmallest.at(length) && point <= 0x10ffff && !control && !line_or_bidi && !surrogate;
}

}  // namespace

std::string Quoted(std::string_view text) {
  std::string out = "\"";
  for (char c : text.substr(0, kQuotedBytesMax)) AppendEscaped(out, c);
  if (text.size() > kQuotedBytesMax) out += "...";
  return out + '"';
}

bool IsPrintableUtf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = SequenceLength(static_cast<unsigned char>(text.front()));
    if (length == 0 || length > text.size()) return false;
    if (!IsPrintable(Decode(text.substr(0, length)), length)) return false;
    text.remove_prefix(length);
  }
  return true;
}

}  // namespace rigcal
