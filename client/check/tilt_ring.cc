#include "client/check/tilt_ring.h"

#include <algorithm>
#include <vector>

#include "client/check/words.h"
#include "server/model/sensors/coverage.h"

namespace rigcal::check {

TiltRing RingOf(const CameraFit& fit) {
  TiltRing ring;
  for (const ViewFit& view : fit.views) {
    if (view.residual_px.empty()) continue;
    const std::array<double, 4> tilts_rad = {-view.tilt_rad.x(), view.tilt_rad.x(), -view.tilt_rad.y(),
                                             view.tilt_rad.y()};
    for (std::size_t side = 0; side < tilts_rad.size(); ++side) {
      ring.largest_rad[side] = std::max(ring.largest_rad[side], tilts_rad[side]);
      if (tilts_rad[side] >= kFlatTilt_rad) ++ring.views[side];
    }
  }
  return ring;
}

std::string OpenSides(const TiltRing& ring) {
  std::vector<std::string> open;
  for (std::size_t side = 0; side < ring.views.size(); ++side)
    if (ring.views[side] < kTiltedViewsMin) open.emplace_back(kTiltSides[side]);
  return Enumerated(open);
}

std::size_t CapturesToClose(const TiltRing& ring) {
  const auto lacking = [&](std::size_t side) {
    return ring.views[side] < kTiltedViewsMin ? kTiltedViewsMin - ring.views[side] : 0;
  };
  return std::max(lacking(0) + lacking(1), lacking(2) + lacking(3));
}

std::optional<BoardDistances> DistancesOf(const CameraFit& fit, const Target& board) {
  const double width_m = PatternSize_m(board).x();
  std::optional<BoardDistances> distances;
  for (const ViewFit& view : fit.views) {
    if (view.residual_px.empty() || !(width_m > 0)) continue;
    const double widths = view.distance_m / width_m;
    if (!distances) distances = BoardDistances{widths, widths};
    distances->near_widths = std::min(distances->near_widths, widths);
    distances->far_widths = std::max(distances->far_widths, widths);
  }
  return distances;
}

}  // namespace rigcal::check
