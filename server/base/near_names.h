// Names that people type: how far one is from another, and which known one was meant.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rigcal {

// Edits that turn one name into the other: a character changed, missing or more, or two neighbours swapped
// (Damerau-Levenshtein, no character edited twice). Names that differ in upper and lower case alone are one edit apart.
[[nodiscard]] std::size_t EditDistance(std::string_view a, std::string_view b);

// Whether `name` is one edit away from `known` and no other name of a series: their numbers are the same but for
// leading zeros, hexadecimal and Roman ones too, and no letter that stands alone or is a word's last capital is another
// letter (mapper-1 of mapper-01, but not mapper-02; not arm-a of arm-b, robotA of robotB, mk-ii of mk-i, unit-7ba of
// unit-7bc). Of names under four characters every edit makes another name.
[[nodiscard]] bool IsSlip(std::string_view name, std::string_view known);

// Of `known` those that `name` may mean, in their order, at most three: those that it is a slip of, else the nearest.
// Up to two edits, and not more than a third of its characters; none where more than three are the nearest.
[[nodiscard]] std::vector<std::string> NearestNames(std::string_view name, std::span<const std::string> known);
// ": did you mean mapper-01?", ": did you mean front, back or top?"; empty of none.
[[nodiscard]] std::string Suggestion(std::span<const std::string> names);

// Every name that is one edit away from `name`, with letters, digits and separators of ids (ids.h), and `name` itself
// all in lower and in upper case. Some twice; about 131 for each character.
[[nodiscard]] std::vector<std::string> NamesOneEditAway(std::string_view name);

}  // namespace rigcal
