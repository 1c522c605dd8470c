// Residual per capture as a small bar chart.
#pragma once

#include <string>
#include <vector>

#include "server/model/edges/edge.h"
#include "server/report/frame/page.h"

namespace rigcal::report {

// Adds the include {{>BARS}}; residuals are in `unit`. Returns a sentence about captures that are not drawn, or
// nothing.
[[nodiscard]] std::string FillBars(Dictionary& parent, const std::vector<CaptureResidual>& captures,
                                   const std::string& unit);

}  // namespace rigcal::report
