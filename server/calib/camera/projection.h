// The camera models: the one projection of this module with its derivatives, and its inverse.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>

#include "server/model/sensors/camera.h"

namespace rigcal::calib {

// By subdivision in Bernstein form; a polynomial that touches zero counts as not positive. At most degree 8.
[[nodiscard]] bool PositiveBySubdivision(const double* coefficients, int count, double s_max);

// Whether c0 + c1 s + c2 s^2 + ... > 0 for every s in [0, s_max]. False where something is NaN.
template <int kCount>
[[nodiscard]] inline bool PositiveUpTo(const Eigen::Matrix<double, kCount, 1>& coefficients, double s_max) {
  double falling = std::min(coefficients[kCount - 1], 0.0);
  for (int i = kCount - 2; i > 0; --i) falling = falling * s_max + std::min(coefficients[i], 0.0);
  // Each negative term is at its lowest at s_max: most points are settled here.
  if (coefficients[0] + falling * s_max > 0) return true;
  return PositiveBySubdivision(coefficients.data(), kCount, s_max);
}

// fx fy cx cy, then the distortion in the order of DistortionNames(model); zeros behind IntrinsicsCount(model).
constexpr int kIntrinsicsMax = 12;
using IntrinsicsVector = Eigen::Matrix<double, kIntrinsicsMax, 1>;
using PointJacobian = Eigen::Matrix<double, 2, 3>;
using IntrinsicsJacobian =
    Eigen::Matrix<double, 2, kIntrinsicsMax, Eigen::RowMajor>;  // columns behind the count are zero

// 9, 12, 8, 6, 6.
[[nodiscard]] constexpr int IntrinsicsCount(CameraModel model) {
  if (IsSphere(model)) return 6;
  if (model == CameraModel::kFisheyeKb4) return 8;
  return model == CameraModel::kPinholeRational ? 12 : 9;
}
// Distortion beyond the model's count is left away, what is missing is zero.
[[nodiscard]] IntrinsicsVector VectorOf(const CameraIntrinsics& intrinsics);
// The first IntrinsicsCount(model) numbers.
[[nodiscard]] IntrinsicsVector PaddedIntrinsics(CameraModel model, const double* values);
[[nodiscard]] CameraIntrinsics IntrinsicsOf(CameraModel model, const IntrinsicsVector& vector);

// The first `count` columns as two rows of an optimiser's Jacobian.
inline void CopyColumns(const IntrinsicsJacobian& d_intrinsics, int count, double* rows) {
  for (int row : {0, 1}) std::copy_n(d_intrinsics.data() + row * kIntrinsicsMax, count, rows + row * count);
}

struct Projection {
  bool in_front = false;  // false: the camera cannot see the point, nothing else is set
  Eigen::Vector2d uv_px = Eigen::Vector2d::Zero();
  PointJacobian d_point = PointJacobian::Zero();
  IntrinsicsJacobian d_intrinsics = IntrinsicsJacobian::Zero();
};
// Not seen are points on or behind the plane of a pinhole, and points so far out that the radial distortion has folded
// over on the way from the axis to them (its slope by the radius, or by the angle of a fisheye, was not positive).
// A fisheye sees points beyond 90 degrees where its series still grows, a sphere model where its image still does.
[[nodiscard]] Projection Project(CameraModel model, const IntrinsicsVector& intrinsics, const Eigen::Vector3d& p_cam,
                                 bool with_derivatives = true);

// The unit ray that projects to the pixel (Newton on the unit sphere, to 1e-8 px; of the sphere models in closed form);
// nothing where no visible ray does.
[[nodiscard]] std::optional<Eigen::Vector3d> Unproject(CameraModel model, const IntrinsicsVector& intrinsics,
                                                       const Eigen::Vector2d& uv_px);

}  // namespace rigcal::calib
