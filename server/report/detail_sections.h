// The folds of all edges: those that one cause explains in a fold of their own.
#pragma once

#include "server/report/cause_groups.h"

namespace rigcal::report {

void FillDetails(Dictionary& page, const ReportInput& input, const EdgesByCause& edges);

}  // namespace rigcal::report
