// A board on a sheet of paper: the pattern, a ruler along each side, and the words that say what it is.
#pragma once

#include <string>
#include <vector>

#include "client/print/pattern.h"

namespace rigcal::print {

struct Label {
  double x_m = 0, y_m = 0;  // where its base line begins
  double height_m = 0;      // of the type
  std::string text;
  bool is_monospace = false;
};

// Everything from the top left of the paper, x to the right, y down.
struct Sheet {
  std::string paper;                        // "A3", "letter", or "custom"
  double width_m = 0, height_m = 0;         // as it lies: upright or across
  double pattern_x_m = 0, pattern_y_m = 0;  // of the top left of the pattern
  double ruler_x_m = 0, ruler_y_m = 0;      // lengths of the two rulers, whole multiples of 100 mm
  std::vector<Rectangle> black;             // the pattern, and the lines of the rulers
  std::vector<Label> labels;
  std::vector<Disc> discs = {};  // of the pattern
};

// Of `--paper`: A4, A3, A2, A1, A0, letter, auto.
[[nodiscard]] std::vector<std::string> PaperNames();
// `target` must be valid and have a serial. `paper` auto: the smallest of A4 to A0 that takes it, upright or across, or
// else a sheet of its own. kInvalidInput where it does not fit: says what is needed.
[[nodiscard]] Result<Sheet> LayOut(const Target& target, const std::string& paper);

}  // namespace rigcal::print
