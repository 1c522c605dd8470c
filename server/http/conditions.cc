#include "server/http/conditions.h"

#include <algorithm>

#include "server/base/number_text.h"

namespace rigcal::http {
namespace {

std::string_view Trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

// Digits only; nothing if empty, mixed or too large.
std::optional<std::int64_t> Number(std::string_view text) {
  if (text.find_first_not_of("0123456789") != std::string_view::npos) return std::nullopt;
  return NumberIn<std::int64_t>(text);
}

RangeAnswer Part(std::int64_t first, std::int64_t last, std::int64_t size_bytes) {
  if (first >= size_bytes) return {RangeKind::kUnsatisfiable, {}};
  return {RangeKind::kPart, {first, std::min(last, size_bytes - 1)}};
}

bool IsCoding(std::string_view text, std::string_view name) {
  return std::equal(text.begin(), text.end(), name.begin(), name.end(), [](char given, char small) {
    return given == small || (given >= 'A' && given <= 'Z' && given - 'A' + 'a' == small);
  });
}

// Of ";q=0.5"; without a weight it is 1. Only zeros behind "q=" are none.
bool HasWeight(std::string_view parameter) {
  const auto equals = parameter.find('=');
  if (equals == std::string_view::npos) return true;
  return Trimmed(parameter.substr(equals + 1)).find_first_not_of("0.") != std::string_view::npos;
}

}  // namespace

bool MatchesTag(std::string_view if_none_match, const std::string& etag) {
  if (Trimmed(if_none_match) == "*") return true;
  while (!if_none_match.empty()) {
    const auto comma = std::min(if_none_match.find(','), if_none_match.size());
    std::string_view tag = Trimmed(if_none_match.substr(0, comma));
    if (tag.substr(0, 2) == "W/") tag.remove_prefix(2);
    if (tag == etag) return true;
    if_none_match.remove_prefix(std::min(comma + 1, if_none_match.size()));
  }
  return false;
}

bool AcceptsGzip(std::string_view accept_encoding) {
  std::optional<bool> named, any;
  while (!accept_encoding.empty()) {
    const auto comma = std::min(accept_encoding.find(','), accept_encoding.size());
    const std::string_view one = accept_encoding.substr(0, comma);
    const auto semicolon = std::min(one.find(';'), one.size());
    const std::string_view coding = Trimmed(one.substr(0, semicolon));
    if (IsCoding(coding, "gzip")) named = HasWeight(one.substr(semicolon));
    if (coding == "*") any = HasWeight(one.substr(semicolon));
    accept_encoding.remove_prefix(std::min(comma + 1, accept_encoding.size()));
  }
  return named.value_or(any.value_or(false));
}

RangeAnswer ParseRange(std::string_view header, std::int64_t size_bytes) {
  constexpr std::string_view kUnit = "bytes=";
  const std::string_view text = Trimmed(header);
  if (text.substr(0, kUnit.size()) != kUnit) return {};
  const std::string_view spec = Trimmed(text.substr(kUnit.size()));
  const auto dash = spec.find('-');
  if (dash == std::string_view::npos) return {};
  const std::string_view from = Trimmed(spec.substr(0, dash)), to = Trimmed(spec.substr(dash + 1));
  const auto first = Number(from), last = Number(to);
  if (from.empty() && last) {
    if (*last == 0) return {RangeKind::kUnsatisfiable, {}};
    return Part(std::max<std::int64_t>(0, size_bytes - *last), size_bytes - 1, size_bytes);
  }
  if (!first || (!to.empty() && (!last || *last < *first))) return {};
  return Part(*first, last.value_or(size_bytes - 1), size_bytes);
}

}  // namespace rigcal::http
