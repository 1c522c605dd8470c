// Cameras of a revision: a table, and a section of pictures for each.
#pragma once

#include "server/report/frame/page.h"
#include "server/report/render.h"

namespace rigcal::report {

// Every camera's row, and a fold for each up to a limit; cameras of which nothing was kept are named. Without any,
// nothing.
void FillCameras(Dictionary& page, const ReportInput& input);

}  // namespace rigcal::report
