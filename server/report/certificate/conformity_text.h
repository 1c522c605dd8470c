// A decision in a cell of a certificate.
#pragma once

#include <string>

#include "server/report/certificate/figures.h"

namespace rigcal::report {

inline constexpr const char* kNoFigure = "-";

// "yes", "not decided", "no"; kNoFigure where there is no limit.
[[nodiscard]] inline std::string WordOf(Conformity decision) {
  switch (decision) {
    case Conformity::kWithin:
      return "yes";
    case Conformity::kOpen:
      return "not decided";
    case Conformity::kBeyond:
      return "no";
    case Conformity::kNoLimit:
      break;
  }
  return kNoFigure;
}

// A small U is no word for what the verdict does not rely on.
[[nodiscard]] inline std::string WithinText(Conformity decision, bool relied_on) {
  return decision == Conformity::kWithin && !relied_on ? "not verified" : WordOf(decision);
}

}  // namespace rigcal::report
