// The section "Joint refinement" of a revision: how far the refined poses are from those of the graph of pairs.
#pragma once

#include "server/formats/documents.h"
#include "server/report/frame/page.h"

namespace rigcal::report {

// No section where the poses are those of the pairs.
void FillFused(Dictionary& page, const formats::RevisionInput& revision);

}  // namespace rigcal::report
