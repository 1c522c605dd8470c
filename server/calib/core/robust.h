// Middles that a few wrong captures do not move, what is too far from them, and some of many.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

namespace rigcal::calib {

constexpr double kMadSigma = 1.4826;  // of a normal distribution, over the median of absolute values

[[nodiscard]] double MedianOf(std::vector<double> values);  // of an even count the upper one; not empty
// From 0 to pi, exact for small angles too; 0 where a vector is zero.
[[nodiscard]] double AngleBetween_rad(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

// How far boards may be from where the other captures have them: five times what is typical, and never less than a few
// centimetres and degrees.
struct BoardGate {
  double distance_max_m, angle_max_rad;
  // From how far off each board is from where the others have it; neither list is empty.
  BoardGate(const std::vector<double>& distances_m, const std::vector<double>& angles_rad);
  // Both at once.
  [[nodiscard]] bool Passes(double distance_m, double angle_rad) const {
    return distance_m <= distance_max_m && angle_rad <= angle_max_rad;
  }
};

// While intrinsics and T_a_b are rough only gross contradictions count, of swapped or unsynchronized pictures: an rms
// beyond six times the captures' median, and beyond a part of the picture's width.
[[nodiscard]] double ContradictingRms_px(const std::vector<double>& rms_px, double width_px);

// At most so many, evenly spread.
template <typename T>
[[nodiscard]] std::vector<T> SpreadOver(const std::vector<T>& all, std::size_t count_max) {
  const std::size_t count = std::min(all.size(), count_max);
  std::vector<T> spread;
  for (std::size_t i = 0; i < count; ++i) spread.push_back(all[i * all.size() / count]);
  return spread;
}

}  // namespace rigcal::calib
