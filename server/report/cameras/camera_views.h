// The pictures of a camera whose corners fit worst, cut to the board, with where the estimate puts each corner.
#pragma once

#include <set>

#include "server/model/edges/edge.h"
#include "server/model/sensors/camera_fit.h"
#include "server/report/frame/page.h"

namespace rigcal::report {

// `edge`: the one that the fit is of; its pictures are shown as far as they are stored. Nothing where there are none.
void FillWorstViews(Dictionary& section, const CameraFit& fit, const Edge& edge, const std::set<Digest>& stored);

}  // namespace rigcal::report
