#include "server/formats/json/nearest.h"

#include <algorithm>

#include "server/base/near_names.h"

namespace rigcal::formats {
namespace {

constexpr std::size_t kComparedMax = 64;

// A name that was cut short ("fx" of "fx_px") is one step away.
std::size_t Distance(std::string_view name, std::string_view known) {
  return name.size() >= 2 && known.substr(0, name.size()) == name ? 1 : EditDistance(name, known);
}

}  // namespace

std::string_view Nearest(std::string_view name, std::span<const std::string_view> known) {
  name = name.substr(0, kComparedMax);
  std::string_view best;
  std::size_t best_distance = name.size();
  for (const std::string_view candidate : known) {
    const std::size_t distance = Distance(name, candidate);
    if (distance < best_distance && distance <= std::max<std::size_t>(2, candidate.size() / 2)) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

std::string Listed(std::span<const std::string_view> names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 == names.size() ? " and " : ", ";
    text += names[i];
  }
  return text;
}

std::string DidYouMean(std::string_view name, std::span<const std::string_view> known) {
  const std::string_view nearest = Nearest(name, known);
  if (nearest.empty()) return "known here: " + Listed(known);
  return "did you mean \"" + std::string(nearest) + "\"?";
}

}  // namespace rigcal::formats
