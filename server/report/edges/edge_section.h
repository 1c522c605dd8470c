// The section of one edge: pose, figures, residual per capture, what is inside sigma, pictures, diagnoses.
#pragma once

#include <set>

#include "server/report/edges/edge_order.h"
#include "server/report/frame/page.h"

namespace rigcal::report {

// Notes on a good edge. On another one they are why it is not good, which its state says already.
[[nodiscard]] std::size_t WarningsOf(const Edge& edge);

// `stored`: digests of pictures that exist; `pictures_max` of them are shown. `open`: unfolded.
void FillEdgeSection(Dictionary& section, const ReportInput& input, const ShownEdge& shown,
                     const std::set<Digest>& stored, std::size_t pictures_max, bool open);

}  // namespace rigcal::report
