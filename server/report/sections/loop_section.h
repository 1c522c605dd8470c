// The section "Loops" of a revision: how well loops of edges close.
#pragma once

#include "server/formats/documents.h"
#include "server/report/frame/page.h"

namespace rigcal::report {

// No section where nothing is known of loops: revisions of before.
void FillLoops(Dictionary& page, const formats::RevisionInput& revision);

}  // namespace rigcal::report
