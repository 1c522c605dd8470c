// The revisions of a robot to choose from.
#pragma once

#include "server/report/frame/page.h"

namespace rigcal::report {

// Fills `section` once for each from `newest` to 1, as many as a list is good for, and for the chosen one in any case.
void FillChoices(Dictionary& parent, const char* section, int newest, int chosen);

}  // namespace rigcal::report
