// The words on a sheet.
#pragma once

#include <string>
#include <vector>

#include "client/print/sheet.h"

namespace rigcal::print {

// The target as session.yaml takes it: "{type: checkerboard, inner_corners: [9, 6], square_size_m: 0.025, serial:
// B-1}".
[[nodiscard]] std::string YamlOf(const Target& target);

inline constexpr double kWordsHeight_m = 0.030;  // that they take
// In a strip of this width with its top left at x, y.
[[nodiscard]] std::vector<Label> WordsOf(const Target& target, double x_m, double y_m, double width_m);

}  // namespace rigcal::print
