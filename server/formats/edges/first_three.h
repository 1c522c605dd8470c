// What one sentence names of many things.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>

namespace rigcal::formats {

// "a, b, c and 5018 more"; `name_of(i)` of the first three of `count`.
template <typename NameOf>
std::string FirstThree(std::size_t count, const NameOf& name_of) {
  constexpr std::size_t kShown = 3;
  std::string names;
  for (std::size_t i = 0; i < std::min(kShown, count); ++i) names.append(i == 0 ? "" : ", ").append(name_of(i));
  if (count > kShown) names += " and " + std::to_string(count - kShown) + " more";
  return names;
}

}  // namespace rigcal::formats
