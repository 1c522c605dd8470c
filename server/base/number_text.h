// Numbers in text from outside.
#pragma once

#include <charconv>
#include <optional>
#include <string_view>

namespace rigcal {

// The number that all of `text` is, as std::from_chars reads it: without blanks or a plus sign, in any locale. Nothing
// where it is none, anything stands behind it, or it does not fit.
template <typename Number>
[[nodiscard]] std::optional<Number> NumberIn(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(number) : std::nullopt;
}

}  // namespace rigcal
