// The cards below a verdict: a name, a value, and what it is held against.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/model/diagnosis.h"
#include "server/model/verdict_basis.h"
#include "server/report/frame/page.h"

namespace rigcal::report {

struct Figure {
  std::string name, value;
  std::string tone;  // class of its colour: "", "warn", "fail" or one of SigmasClass
  std::vector<std::string> details;
};
// What decided a verdict that asks for something; nothing where no figure did.
[[nodiscard]] std::optional<Figure> DecidingFigureOf(const Verdict& verdict, const VerdictBasis& basis);
// A row of cards of a page ({{>FIGURES}}, or as `place` says), and what it is called; it belongs to `page`.
[[nodiscard]] Dictionary& AddFigures(Dictionary& page, const char* place = "FIGURES",
                                     const char* label = "Key figures");
void AddFigure(Dictionary& figures, const Figure& figure);

}  // namespace rigcal::report
