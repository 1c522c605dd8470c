// A revision for scripts and spreadsheets.
#pragma once

#include <string>
#include <vector>

#include "server/report/edges/edge_order.h"

namespace rigcal::report {

// "window.rigcal = {...};": sensors with poses, sigmas, nominal and previous poses; edges with what their charts show.
[[nodiscard]] std::string PageData(const ReportInput& input, const std::vector<ShownEdge>& edges);
// A heading and a line per edge, all of them: metres, radians; what is not known is empty. Texts that a spreadsheet
// would take for a formula are set off with an apostrophe.
[[nodiscard]] std::string EdgeCsv(const ReportInput& input, const std::vector<ShownEdge>& edges);
// One text as a field of it.
[[nodiscard]] std::string CsvField(const std::string& text);

}  // namespace rigcal::report
