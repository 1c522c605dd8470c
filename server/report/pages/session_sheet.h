// The contact sheet of a session: who saw what in each capture, and what was made of it.
#pragma once

#include "server/report/frame/page.h"
#include "server/report/robot_pages.h"

namespace rigcal::report {

// Fills SHEET, POSES and MORE.
void FillSheet(Dictionary& page, const SessionInput& input);

}  // namespace rigcal::report
