// A sheet as SVG.
#pragma once

#include <string>

#include "client/print/sheet.h"

namespace rigcal::print {

// At true size: a unit is a millimetre, written to 0.1 micrometre. The same sheet gives the same bytes everywhere.
[[nodiscard]] std::string WriteSvg(const Sheet& sheet, const std::string& title);

}  // namespace rigcal::print
