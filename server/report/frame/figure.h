// The cards below a verdict: a name, a value, and what it is held against.
#pragma once

#include <string>
#include <vector>

#include "server/report/frame/page.h"

namespace rigcal::report {

struct Figure {
  std::string name, value;
  std::string tone;  // class of its colour: "", "warn", "fail" or one of SigmasClass
  std::vector<std::string> details;
};
// The row of cards ({{>FIGURES}}) of a page; it belongs to `page`.
[[nodiscard]] Dictionary& AddFigures(Dictionary& page);
void AddFigure(Dictionary& figures, const Figure& figure);

}  // namespace rigcal::report
