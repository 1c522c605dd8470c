// The section "As found, as left" of a revision: how far the calibration in use was off by its newest session, and what
// is left.
#pragma once

#include "server/report/frame/page.h"
#include "server/report/render.h"

namespace rigcal::report {

// No section where the revision has none.
void FillAsFound(Dictionary& page, const ReportInput& input);

}  // namespace rigcal::report
