// The folds of all edges: those that one cause explains in a fold of their own.
#pragma once

#include "server/report/edges/cause_groups.h"

namespace rigcal::report {

// Of edges that are `detailed`; the others are counted, with where to find them.
void FillDetails(Dictionary& page, const ReportInput& input, const EdgesByCause& edges);

}  // namespace rigcal::report
