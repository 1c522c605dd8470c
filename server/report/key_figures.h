// The cards beside the drawing: E_global, cost, edges, sensors; and the notes of the solution.
#pragma once

#include "server/report/page.h"
#include "server/report/render.h"

namespace rigcal::report {

void FillKeyFigures(Dictionary& page, const formats::RevisionInput& revision);
void FillNotes(Dictionary& page, const formats::RevisionInput& revision);

}  // namespace rigcal::report
