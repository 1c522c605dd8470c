#include "server/calib/projection.h"

namespace rigcal::calib {
namespace {

// Nearer than this a point is on the lens: its projection says nothing.
constexpr double kNearestDepth_m = 1e-6;

struct Distorted {
  Eigen::Vector2d xy;
  Eigen::Matrix2d d_xy;                  // by the undistorted coordinates
  Eigen::Matrix<double, 2, 5> d_params;  // by k1 k2 p1 p2 k3
};

Distorted Distort(const IntrinsicsVector& intrinsics, double x, double y) {
  const double k1 = intrinsics[4], k2 = intrinsics[5], p1 = intrinsics[6], p2 = intrinsics[7], k3 = intrinsics[8];
  const double r2 = x * x + y * y, r4 = r2 * r2, r6 = r4 * r2;
  const double radial = 1 + k1 * r2 + k2 * r4 + k3 * r6;
  const double slope = k1 + 2 * k2 * r2 + 3 * k3 * r4;  // d radial / d r2
  Distorted result;
  result.xy << x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x), y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y;
  const double mixed = 2 * x * y * slope + 2 * p1 * x + 2 * p2 * y;
  result.d_xy << radial + 2 * x * x * slope + 2 * p1 * y + 6 * p2 * x, mixed,  //
      mixed, radial + 2 * y * y * slope + 6 * p1 * y + 2 * p2 * x;
  result.d_params << x * r2, x * r4, 2 * x * y, r2 + 2 * x * x, x * r6,  //
      y * r2, y * r4, r2 + 2 * y * y, 2 * x * y, y * r6;
  return result;
}

}  // namespace

IntrinsicsVector VectorOf(const PinholeRadtan& intrinsics) {
  IntrinsicsVector vector;
  vector << intrinsics.fx_px, intrinsics.fy_px, intrinsics.cx_px, intrinsics.cy_px,
      Eigen::Map<const Eigen::Matrix<double, 5, 1>>(intrinsics.distortion.data());
  return vector;
}

PinholeRadtan IntrinsicsOf(const IntrinsicsVector& vector) {
  PinholeRadtan intrinsics{vector[0], vector[1], vector[2], vector[3], {}};
  for (std::size_t i = 0; i < intrinsics.distortion.size(); ++i)
    intrinsics.distortion[i] = vector[4 + static_cast<Eigen::Index>(i)];
  return intrinsics;
}

Projection Project(const IntrinsicsVector& intrinsics, const Eigen::Vector3d& p_cam) {
  Projection result;
  if (!(p_cam.z() > kNearestDepth_m)) return result;
  result.in_front = true;
  const double inverse_z = 1 / p_cam.z(), x = p_cam.x() * inverse_z, y = p_cam.y() * inverse_z;
  const Distorted distorted = Distort(intrinsics, x, y);
  const Eigen::Vector2d focal = intrinsics.head<2>();
  result.uv_px = focal.cwiseProduct(distorted.xy) + intrinsics.segment<2>(2);

  Eigen::Matrix<double, 2, 3> d_normalized;
  d_normalized << inverse_z, 0, -x * inverse_z, 0, inverse_z, -y * inverse_z;
  result.d_point = focal.asDiagonal() * distorted.d_xy * d_normalized;
  result.d_intrinsics.leftCols<2>() = distorted.xy.asDiagonal();
  result.d_intrinsics.middleCols<2>(2).setIdentity();
  result.d_intrinsics.rightCols<5>() = focal.asDiagonal() * distorted.d_params;
  return result;
}

}  // namespace rigcal::calib
