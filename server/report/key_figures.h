// The cards below the verdict: E_global, chi-square, worst edge, worst sensor; and the notes of the solution.
#pragma once

#include "server/report/edge_order.h"
#include "server/report/page.h"

namespace rigcal::report {

void FillKeyFigures(Dictionary& page, const formats::RevisionInput& revision, const std::vector<ShownEdge>& edges);
void FillNotes(Dictionary& page, const formats::RevisionInput& revision);

}  // namespace rigcal::report
