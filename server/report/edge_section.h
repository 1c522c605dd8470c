// The section of one edge: pose, figures, residual per capture, what is inside sigma, pictures, diagnoses.
#pragma once

#include <set>

#include "server/report/edge_order.h"
#include "server/report/page.h"

namespace rigcal::report {

// `stored`: digests of pictures that exist. `open`: unfolded.
void FillEdgeSection(Dictionary& section, const ReportInput& input, const ShownEdge& shown,
                     const std::set<Digest>& stored, bool open);

}  // namespace rigcal::report
