#include "server/calib/camera/fisheye_start.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/calib/planes/placed_boards.h"

namespace rigcal::calib {
namespace {

// Of the longer side.
constexpr std::array<double, 9> kFields_deg = {50, 65, 85, 105, 125, 150, 175, 200, 230};
constexpr std::size_t kViewsTried = 12;

IntrinsicsVector Equidistant(const CameraViews& views, double field_deg) {
  IntrinsicsVector intrinsics = IntrinsicsVector::Zero();
  const double focal_px = std::max(views.width_px, views.height_px) / (field_deg * M_PI / 180);
  intrinsics.head<4>() << focal_px, focal_px, 0.5 * (views.width_px - 1), 0.5 * (views.height_px - 1);
  return intrinsics;
}

}  // namespace

IntrinsicsVector RoughFisheye(const CameraViews& views) {
  const CameraViews tried = Spread(views, kViewsTried);
  std::array<double, kFields_deg.size()> costs_px2{};
  for (std::size_t i = 0; i < kFields_deg.size(); ++i)
    costs_px2[i] = PlaceBoards(tried, Equidistant(tried, kFields_deg[i])).cost_px2;
  const auto best = std::min_element(costs_px2.begin(), costs_px2.end()) - costs_px2.begin();
  return Equidistant(views, kFields_deg[static_cast<std::size_t>(best)]);
}

}  // namespace rigcal::calib
