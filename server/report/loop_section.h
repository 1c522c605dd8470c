// The section "Loops" of a revision: how well loops of edges close.
#pragma once

#include "server/model/insight.h"
#include "server/report/page.h"

namespace rigcal::report {

// No section where nothing is known of loops: revisions of before.
void FillLoops(Dictionary& page, const Cycles& cycles);

}  // namespace rigcal::report
