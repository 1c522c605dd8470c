// The causes of failed pairs below the banner: each with one thing to do, a command to copy, and the edges that it
// explains.
#pragma once

#include "server/report/edges/edge_order.h"
#include "server/report/frame/page.h"

namespace rigcal::report {

// Nothing where the revision keeps none.
void FillCauses(Dictionary& page, const std::vector<Cause>& causes, const std::vector<ShownEdge>& edges);

}  // namespace rigcal::report
