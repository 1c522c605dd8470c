#include "server/fleet/wording.h"

#include <array>
#include <cmath>
#include <cstdio>

namespace rigcal::fleet {
namespace {
constexpr std::size_t kNamesMax = 6;
}  // namespace

std::string Number(double value, const char* unit) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), std::abs(value) < 100.0 ? "%.3g %s" : "%.0f %s", value, unit);
  return text.data();
}

std::string LimitText(double value) {
  std::string text = Number(value, "");
  text.pop_back();
  return text;
}

std::string List(const std::vector<std::string>& names) {
  const std::size_t shown = names.size() > kNamesMax ? kNamesMax : names.size();
  std::string text;
  for (std::size_t k = 0; k < shown; ++k) {
    const bool last = k + 1 == names.size();
    if (k > 0) text += last ? " and " : ", ";
    text += names[k];
  }
  if (names.size() > shown) text += " and " + std::to_string(names.size() - shown) + " more";
  return text;
}

std::string NameOfEdge(const Edge& edge) { return edge.frame_a.str() + " - " + edge.frame_b.str(); }

std::string OffText(const Vector6d& e) {
  // Less than a millionth of a millimetre or degree is arithmetic, not a disagreement.
  const auto amount = [](double value, const char* unit) { return Number(value < 1e-6 ? 0.0 : value, unit); };
  return amount(1e3 * e.head<3>().norm(), "mm") + " and " + amount(kDegreesPerRadian * e.tail<3>().norm(), "deg");
}

}  // namespace rigcal::fleet
