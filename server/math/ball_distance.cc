#include "server/math/ball_distance.h"

#include <Eigen/Cholesky>

namespace rigcal {
namespace {

// The multiplier at which `excess`, which falls with it, is zero; 0 where it is below zero without one.
template <typename Excess>
double MultiplierOf(double scale, const Excess& excess) {
  constexpr int kDoublings = 200, kHalvings = 80;
  if (excess(0.0) <= 0) return 0.0;
  double low = 0.0, high = scale;
  for (int i = 0; i < kDoublings && excess(high) > 0; ++i) low = high, high *= 2;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = low + (high - low) / 2;
    (excess(middle) > 0 ? low : high) = middle;
  }
  return high;
}

}  // namespace

double SquaredDistanceFromBalls(const Vector6d& step, const Matrix6d& W, double radius_m, double radius_rad) {
  const auto translation = [](const Vector6d& y) { return y.segment<3>(tangent::kTranslation).norm(); };
  const auto rotation = [](const Vector6d& y) { return y.segment<3>(tangent::kRotation).norm(); };
  const double scale = W.trace() / 6;
  const auto nearest = [&](double mu, double nu) -> Vector6d {
    Matrix6d H = W;
    H.diagonal().segment<3>(tangent::kTranslation).array() += mu;
    H.diagonal().segment<3>(tangent::kRotation).array() += nu;
    return H.ldlt().solve(W * step);
  };
  const auto mu_of = [&](double nu) {
    return MultiplierOf(scale, [&](double mu) { return translation(nearest(mu, nu)) - radius_m; });
  };
  const double nu =
      MultiplierOf(scale, [&](double value) { return rotation(nearest(mu_of(value), value)) - radius_rad; });
  const Vector6d apart = step - nearest(mu_of(nu), nu);
  return apart.dot(W * apart);
}

}  // namespace rigcal
