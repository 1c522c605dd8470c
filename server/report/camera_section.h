// Cameras of a revision: a table, and a section of pictures for each.
#pragma once

#include "server/report/page.h"
#include "server/report/render.h"

namespace rigcal::report {

void FillCameras(Dictionary& page, const ReportInput& input);

}  // namespace rigcal::report
