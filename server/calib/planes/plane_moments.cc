#include "server/calib/planes/plane_moments.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace rigcal::calib {
namespace {

constexpr double kFlattestCosine = 0.3;
constexpr double kSmallestRangeSigma_m = 1e-4;  // of perfect data: weights stay finite

double CosineAt(const Eigen::Vector3d& p_lidar, const Eigen::Vector3d& normal) {
  return std::max(std::abs(p_lidar.normalized().dot(normal)), kFlattestCosine);
}

struct OwnPlane {
  Eigen::Vector3d normal;
  double offset_m;
};

OwnPlane PlaneOf(const std::vector<Eigen::Vector3f>& points_m) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3f& p : points_m) mean += p.cast<double>();
  mean /= static_cast<double>(points_m.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3f& p : points_m) {
    const Eigen::Vector3d q = p.cast<double>() - mean;
    scatter += q * q.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
  const Eigen::Vector3d normal = solver.eigenvectors().col(0);
  return {normal, normal.dot(mean)};
}

}  // namespace

PlaneMoments MomentsOf(const PlanePatch& patch, double range_sigma_m) {
  PlaneMoments moments;
  for (const Eigen::Vector3f& point : patch.points_m) {
    const Eigen::Vector3d p = point.cast<double>();
    const double sigma_m = range_sigma_m * CosineAt(p, patch.normal);
    Vector7d row;
    row << p, p.normalized(), 1.0;
    const double weight_per_m2 = 1 / (sigma_m * sigma_m);
    moments.sum += weight_per_m2 * row * row.transpose();
    // What range noise alone adds is largest for a plane that faces the ray: left in, it would tilt every plane away.
    moments.sum.topLeftCorner<3, 3>() -=
        weight_per_m2 * range_sigma_m * range_sigma_m * row.segment<3>(3) * row.segment<3>(3).transpose();
    moments.weight_per_m2 += weight_per_m2;
  }
  return moments;
}

double LeastSquares(const PlaneMoments& moments) {
  const Eigen::Vector3d mean = moments.sum.block<3, 1>(0, 6) / moments.weight_per_m2;
  const Eigen::Matrix3d scatter = moments.sum.topLeftCorner<3, 3>() - moments.weight_per_m2 * mean * mean.transpose();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvalues()[0];
}

double RangeSigma_m(const std::vector<const PlanePatch*>& patches) {
  double sum_m2 = 0;
  std::ptrdiff_t dof = 0;
  for (const PlanePatch* patch : patches) {
    if (patch->points_m.size() <= 3) continue;
    const OwnPlane plane = PlaneOf(patch->points_m);
    for (const Eigen::Vector3f& point : patch->points_m) {
      const Eigen::Vector3d p = point.cast<double>();
      const double range_error_m = (plane.normal.dot(p) - plane.offset_m) / CosineAt(p, plane.normal);
      sum_m2 += range_error_m * range_error_m;
    }
    dof += static_cast<std::ptrdiff_t>(patch->points_m.size()) - 3;
  }
  return dof > 0 ? std::max(kSmallestRangeSigma_m, std::sqrt(sum_m2 / static_cast<double>(dof)))
                 : kSmallestRangeSigma_m;
}

}  // namespace rigcal::calib
