#include "server/calib/core/robust.h"

#include <Eigen/Geometry>
#include <cmath>

namespace rigcal::calib {
namespace {

constexpr double kContradictingRatio = 5.0;  // times the typical size of the captures' residuals
constexpr double kContradictingMin_m = 0.03, kContradictingMin_rad = 0.05;
constexpr double kGrossRatio = 6.0, kGrossWidthRatio = 0.02;

}  // namespace

double MedianOf(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double AngleBetween_rad(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

BoardGate::BoardGate(const std::vector<double>& distances_m, const std::vector<double>& angles_rad)
    : distance_max_m(std::max(kContradictingMin_m, kContradictingRatio * kMadSigma * MedianOf(distances_m))),
      angle_max_rad(std::max(kContradictingMin_rad, kContradictingRatio * MedianOf(angles_rad))) {}

double ContradictingRms_px(const std::vector<double>& rms_px, double width_px) {
  return std::max(kGrossRatio * MedianOf(rms_px), kGrossWidthRatio * width_px);
}

}  // namespace rigcal::calib
