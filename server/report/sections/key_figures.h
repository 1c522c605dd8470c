// The cards below the verdict: E_global, chi-square, worst edge, worst sensor; and the notes of the solution.
#pragma once

#include "server/report/edges/edge_order.h"
#include "server/report/frame/page.h"

namespace rigcal::report {

// The figures on top: mean squared disagreement, cost, and the worst edge and sensor.
void FillKeyFigures(Dictionary& page, const formats::RevisionInput& revision, const std::vector<ShownEdge>& edges);
// What the solution tells beside the verdict; beyond a limit only how many more there are.
void FillNotes(Dictionary& page, const formats::RevisionInput& revision);

}  // namespace rigcal::report
