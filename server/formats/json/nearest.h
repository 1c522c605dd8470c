// "did you mean": the known name nearest to a misspelt one.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace rigcal::formats {

// Nearest by edit distance, the first of equals; empty if even that one is a different word.
[[nodiscard]] std::string_view Nearest(std::string_view name, std::span<const std::string_view> known);
// "a, b and c".
[[nodiscard]] std::string Listed(std::span<const std::string_view> names);
// did you mean "robot"?  or, if nothing is near:  known here: a, b and c
[[nodiscard]] std::string DidYouMean(std::string_view name, std::span<const std::string_view> known);

}  // namespace rigcal::formats
