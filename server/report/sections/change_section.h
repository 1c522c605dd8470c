// "What changed since revision N" on a revision's page, and the rows of moved sensors that the comparison shows, too.
#pragma once

#include "server/report/frame/page.h"
#include "server/report/render.h"
#include "server/report/text/changes.h"

namespace rigcal::report {

// Fills CHANGES, or FIRST if there is no revision before this one.
void FillChanges(Dictionary& page, const ReportInput& input);
// One MOVE row: SENSOR, MM, DEG, IN_SIGMAS, LEVEL, and the numbers to sort by.
void FillMove(Dictionary& row, const SensorMove& move);

}  // namespace rigcal::report
