#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "server/calib/camera/projection.h"

namespace rigcal::calib {
namespace {

constexpr int kStepsMax = 60, kHalvingsMax = 40;
constexpr double kSolved_px = 1e-8;
// Below this the last step changed nothing but rounding.
constexpr double kExact_px = 1e-11;

// Where an undistorted lens of the model has the pixel.
Eigen::Vector3d UndistortedRay(CameraModel model, const IntrinsicsVector& intrinsics, const Eigen::Vector2d& uv_px) {
  const Eigen::Vector2d xy = (uv_px - intrinsics.segment<2>(2)).cwiseQuotient(intrinsics.head<2>());
  if (model != CameraModel::kFisheyeKb4) return Eigen::Vector3d(xy.x(), xy.y(), 1).normalized();
  const double theta = xy.norm();
  if (!(theta > 0)) return Eigen::Vector3d::UnitZ();
  const double bounded = std::min(theta, 0.9 * M_PI);
  return {std::sin(bounded) * xy.x() / theta, std::sin(bounded) * xy.y() / theta, std::cos(bounded)};
}

// Two unit vectors across the ray.
Eigen::Matrix<double, 3, 2> Across(const Eigen::Vector3d& ray) {
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = ray.unitOrthogonal();
  basis.col(1) = ray.cross(basis.col(0));
  return basis;
}

struct Guess {
  Eigen::Vector3d ray;
  Projection projection;
  double error_px = 0;
};

Guess GuessAt(CameraModel model, const IntrinsicsVector& intrinsics, const Eigen::Vector3d& ray,
              const Eigen::Vector2d& uv_px) {
  Guess guess{ray.normalized(), {}, 0};
  guess.projection = Project(model, intrinsics, guess.ray);
  guess.error_px = (guess.projection.uv_px - uv_px).norm();
  return guess;
}

}  // namespace

std::optional<Eigen::Vector3d> Unproject(CameraModel model, const IntrinsicsVector& intrinsics,
                                         const Eigen::Vector2d& uv_px) {
  if (!uv_px.allFinite() || !intrinsics.allFinite()) return std::nullopt;
  Eigen::Vector3d ray = UndistortedRay(model, intrinsics, uv_px);
  Guess guess = GuessAt(model, intrinsics, ray, uv_px);
  // Towards the axis until it is seen.
  for (int i = 0; i < kHalvingsMax && !guess.projection.in_front; ++i) {
    ray = ray.normalized() + 0.3 * Eigen::Vector3d::UnitZ();
    guess = GuessAt(model, intrinsics, ray, uv_px);
  }
  if (!guess.projection.in_front) return std::nullopt;
  for (int i = 0; i < kStepsMax && guess.error_px > kExact_px; ++i) {
    const Eigen::Matrix<double, 3, 2> across = Across(guess.ray);
    const Eigen::Matrix2d slope = guess.projection.d_point * across;
    Eigen::Vector2d step = slope.fullPivLu().solve(uv_px - guess.projection.uv_px);
    step *= std::min(1.0, 0.5 / step.norm());
    Guess next = guess;
    for (int halving = 0; halving < kHalvingsMax; ++halving, step *= 0.5) {
      next = GuessAt(model, intrinsics, guess.ray + across * step, uv_px);
      if (next.projection.in_front && next.error_px < guess.error_px) break;
    }
    if (!(next.projection.in_front && next.error_px < guess.error_px)) break;
    guess = next;
  }
  if (!(guess.error_px < kSolved_px)) return std::nullopt;
  return guess.ray;
}

}  // namespace rigcal::calib
