#include "server/cloud/lens.h"

#include <algorithm>

namespace rigcal::cloud {
namespace {

constexpr double kStep_rad = 5e-4;
constexpr double kPinholeWidest_rad = 1.55;  // tan 48: no pinhole lens is wider

double Given(const std::vector<double>& values, std::size_t i) { return i < values.size() ? values[i] : 0.0; }

// Of x N(s) / D(s) by x, with s = x^2; nothing good where the denominator vanishes.
double PinholeSlope(const std::array<float, 6>& k, double s) {
  const double above = 1 + s * (k[0] + s * (k[1] + s * k[2])), below = 1 + s * (k[3] + s * (k[4] + s * k[5]));
  const double above_slope = k[0] + s * (2 * k[1] + 3 * k[2] * s), below_slope = k[3] + s * (2 * k[4] + 3 * k[5] * s);
  if (!(below > 0)) return -1;
  return (above * below + 2 * s * (above_slope * below - above * below_slope)) / (below * below);
}

double FisheyeSlope(const std::array<float, 6>& k, double s) {
  return 1 + s * (3 * k[0] + s * (5 * k[1] + s * (7 * k[2] + s * 9 * k[3])));
}

// The last angle up to which the image grows outwards.
template <typename Slope>
double LastGrowing_rad(double widest_rad, const Slope& slope) {
  double last = 0;
  for (double angle = 0; angle < widest_rad && slope(angle) > 0; angle += kStep_rad) last = angle;
  return last;
}

}  // namespace

Lens::Lens(const CameraIntrinsics& intrinsics)
    : wide_(!IsPinhole(intrinsics.model)),
      sphere_(IsSphere(intrinsics.model)),
      focal_(static_cast<float>(intrinsics.fx_px), static_cast<float>(intrinsics.fy_px)),
      centre_(static_cast<float>(intrinsics.cx_px), static_cast<float>(intrinsics.cy_px)) {
  const auto at = [&](std::size_t i) { return static_cast<float>(Given(intrinsics.distortion, i)); };
  if (sphere_) {
    const bool eucm = intrinsics.model == CameraModel::kEucm;
    xi_ = eucm ? 0 : at(0), alpha_ = eucm ? at(0) : at(1), beta_ = eucm ? at(1) : 1;
    return;
  }
  if (wide_) {
    k_ = {at(0), at(1), at(2), at(3), 0, 0};
    limit_ = static_cast<float>(LastGrowing_rad(M_PI, [&](double angle) { return FisheyeSlope(k_, angle * angle); }));
    return;
  }
  const bool rational = intrinsics.model == CameraModel::kPinholeRational;
  k_ = {at(0), at(1), at(4), rational ? at(5) : 0, rational ? at(6) : 0, rational ? at(7) : 0};
  p1_ = at(2), p2_ = at(3);
  const double widest_rad = LastGrowing_rad(
      kPinholeWidest_rad, [&](double angle) { return PinholeSlope(k_, std::tan(angle) * std::tan(angle)); });
  limit_ = static_cast<float>(std::tan(widest_rad) * std::tan(widest_rad));
}

Lens::Lens(const CameraIntrinsics& intrinsics, int width_px, int height_px) : Lens(intrinsics) {
  if (wide_) return;
  const Eigen::Vector2f size(static_cast<float>(width_px), static_cast<float>(height_px));
  const float corner_px = 1.2F * (centre_.cwiseAbs().cwiseMax((size - centre_).cwiseAbs())).norm();
  const float focal = std::min(focal_.x(), focal_.y());
  const double widest_rad = std::atan(std::sqrt(limit_));
  for (double angle = 0; angle < widest_rad; angle += kStep_rad) {
    const auto x = static_cast<float>(std::tan(angle)), s = x * x;
    const float above = 1 + s * (k_[0] + s * (k_[1] + s * k_[2])), below = 1 + s * (k_[3] + s * (k_[4] + s * k_[5]));
    if (focal * x * above / below < corner_px) continue;
    limit_ = std::min(limit_, s);
    return;
  }
}

}  // namespace rigcal::cloud
