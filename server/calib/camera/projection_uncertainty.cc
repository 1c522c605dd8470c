#include "server/calib/camera/projection_uncertainty.h"

#include <cmath>

#include "server/calib/camera/projection.h"
#include "server/math/se3.h"
#include "server/model/coverage.h"

namespace rigcal::calib {
namespace {

using PointMotion = Eigen::Matrix<double, 3, Eigen::Dynamic>;  // of a point, by the intrinsics

// The square root of the larger eigenvalue.
std::optional<double> WorstDirection(const Eigen::Matrix2d& variance) {
  const double mean = 0.5 * variance.trace(), half = 0.5 * (variance(0, 0) - variance(1, 1));
  const double largest = mean + std::hypot(half, 0.5 * (variance(0, 1) + variance(1, 0)));
  if (!std::isfinite(largest)) return std::nullopt;
  return std::sqrt(std::max(largest, 0.0));
}

std::optional<double> SigmaOfPoint(const CameraFit& fit, const IntrinsicsVector& intrinsics,
                                   const Eigen::Vector3d& p_cam, const PointMotion& motion) {
  const Projection at = Project(fit.intrinsics.model, intrinsics, p_cam);
  if (!at.in_front) return std::nullopt;
  const Eigen::Matrix<double, 2, Eigen::Dynamic> P =
      at.d_intrinsics.leftCols(fit.covariance.cols()) + at.d_point * motion;
  return WorstDirection(P * fit.covariance * P.transpose());
}

PointSigma SigmaAt(const CameraFit& fit, const IntrinsicsVector& intrinsics, const Eigen::Vector2d& uv_px) {
  const auto ray = Unproject(fit.intrinsics.model, intrinsics, uv_px);
  if (!ray) return {};
  const PointMotion turn = -Hat(*ray) * fit.implied_motion.bottomRows<3>();
  const PointMotion shift = fit.implied_motion.topRows<3>();
  return {SigmaOfPoint(fit, intrinsics, *ray, turn),
          SigmaOfPoint(fit, intrinsics, kNearPoint_m * *ray, kNearPoint_m * turn + shift)};
}

}  // namespace

std::optional<ProjectionUncertainty> UncertaintyOfProjections(const CameraFit& fit) {
  if (fit.covariance.size() == 0 || fit.width_px <= 0 || fit.height_px <= 0) return std::nullopt;
  const IntrinsicsVector intrinsics = VectorOf(fit.intrinsics);
  const Coverage coverage = CoverageOf(fit);
  ProjectionUncertainty map{coverage.columns, coverage.rows, {}, {}};
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.columns; ++column)
      map.fields.push_back(SigmaAt(
          fit, intrinsics, {MiddleOf(column, fit.width_px, map.columns), MiddleOf(row, fit.height_px, map.rows)}));
  map.middle = SigmaAt(fit, intrinsics, {MiddleOf(0, fit.width_px, 1), MiddleOf(0, fit.height_px, 1)});
  return map;
}

}  // namespace rigcal::calib
