// The revisions of a robot to choose from.
#pragma once

#include <vector>

#include "server/report/page.h"

namespace rigcal::report {

// Fills `section` once for each: the newest first, as many as a list is good for, and the chosen one in any case.
void FillChoices(Dictionary& parent, const char* section, std::vector<int> numbers, int chosen);

}  // namespace rigcal::report
