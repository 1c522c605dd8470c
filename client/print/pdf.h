// Sheets as the pages of a PDF, drawn by cairo.
#pragma once

#include <string>
#include <vector>

#include "client/print/sheet.h"

namespace rigcal::print {

// At true size, to 2 micrometres. The same sheet gives the same bytes on one machine: the fonts are its own, and no
// time is in it. kStorage with cairo's words where it fails.
[[nodiscard]] Result<std::string> WritePdf(const Sheet& sheet, const std::string& title);
// Likewise of several pages; `sheets`: at least one, all of the size of the first.
[[nodiscard]] Result<std::string> WritePdf(const std::vector<Sheet>& sheets, const std::string& title);

}  // namespace rigcal::print
