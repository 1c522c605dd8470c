#include "client/sim/rig/bend.h"

#include <cmath>

#include "client/sim/rig/random.h"

namespace rigcal::sim {

double Bend::At(const Eigen::Vector2d& ab_m) const {
  if (is_flat()) return 0.0;
  const double along = axis.dot(ab_m) / reach_m, across = (axis.x() * ab_m.y() - axis.y() * ab_m.x()) / reach_m;
  return height_m * (along * along - (is_saddle ? across * across : 0.0));
}

Bend DrawBend(double height_m, const Eigen::Vector2d& plate_m, std::uint64_t key) {
  if (height_m == 0) return {};
  Random random(key);
  const double side = random.Uniform() < 0.5 ? -1 : 1;
  const bool is_saddle = random.Uniform() < 0.5;
  const double angle = random.Uniform(0, M_PI);
  return {side * height_m, is_saddle, {std::cos(angle), std::sin(angle)}, plate_m.norm() / 2};
}

}  // namespace rigcal::sim
