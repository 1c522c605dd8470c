// The cards below the verdict: when measured, worst sensor, worst edge, E_global, chi-square; and the notes of the
// solution.
#pragma once

#include "server/report/edges/edge_order.h"
#include "server/report/frame/page.h"

namespace rigcal::report {

// The figures on top, three that a technician needs first; those of the solution as a whole, which decide nothing by
// themselves, stand below the drawing.
void FillKeyFigures(Dictionary& page, const formats::RevisionInput& revision, const std::vector<ShownEdge>& edges,
                    const Validity& validity);
// What the solution tells beside the verdict; beyond a limit only how many more there are.
void FillNotes(Dictionary& page, const formats::RevisionInput& revision);

}  // namespace rigcal::report
