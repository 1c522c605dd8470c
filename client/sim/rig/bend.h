// How a board departs from the plane that it is taken for.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace rigcal::sim {

// A cylinder or a saddle about the plate's middle.
struct Bend {
  double height_m = 0.0;  // into the plate, `reach_m` from the middle along `axis`; 0: flat
  bool is_saddle = false;
  Eigen::Vector2d axis = Eigen::Vector2d::UnitX();  // unit: the way it bends
  double reach_m = 1.0;                             // half of the plate's diagonal

  [[nodiscard]] bool is_flat() const { return height_m == 0.0; }  // not bent at all
  // Into the plate, at a point of the plate's plane.
  [[nodiscard]] double At(const Eigen::Vector2d& ab_m) const;
};

// Kind, direction and side are drawn.
[[nodiscard]] Bend DrawBend(double height_m, const Eigen::Vector2d& plate_m, std::uint64_t key);

}  // namespace rigcal::sim
