// Projection of very many points: single precision, no derivatives, one camera's constants worked out once.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>

#include "server/model/sensors/camera.h"

namespace rigcal::cloud {

// The same formulas as calib::Project (tests hold the two against each other). Where the lens folds over is found once
// per camera here, by walking outwards from the axis, instead of once per point.
class Lens {
 public:
  // For pictures of any size. What a list of distortion lacks counts as 0.
  explicit Lens(const CameraIntrinsics& intrinsics);
  // For a picture of this size: what lies well outside of it may count as not seen.
  Lens(const CameraIntrinsics& intrinsics, int width_px, int height_px);

  // False: behind the camera or beyond the fold; then uv_px says nothing.
  [[nodiscard]] bool Project(const Eigen::Vector3f& p_cam, Eigen::Vector2f& uv_px) const {
    if (!wide_) return ProjectPinhole(p_cam, uv_px);
    return sphere_ ? ProjectSphere(p_cam, uv_px) : ProjectFisheye(p_cam, uv_px);
  }
  // False only where Project says so too; without a branch, for the many points that a camera does not see.
  [[nodiscard]] bool MayProject(const Eigen::Vector3f& p_cam) const {
    const bool ahead = p_cam.z() > kNearest_m, near = p_cam.head<2>().squaredNorm() < limit_ * p_cam.z() * p_cam.z();
    return wide_ | (ahead & near);
  }
  // Pixels per radian on the axis, the larger of the two.
  [[nodiscard]] float focal_px() const { return std::max(focal_.x(), focal_.y()) / (1 + xi_); }

 private:
  [[nodiscard]] bool ProjectPinhole(const Eigen::Vector3f& p_cam, Eigen::Vector2f& uv_px) const {
    if (!MayProject(p_cam)) return false;
    const float inverse_z = 1 / p_cam.z(), x = p_cam.x() * inverse_z, y = p_cam.y() * inverse_z, s = x * x + y * y;
    const float above = 1 + s * (k_[0] + s * (k_[1] + s * k_[2])), below = 1 + s * (k_[3] + s * (k_[4] + s * k_[5]));
    const float radial = above / below, xy2 = 2 * x * y;
    uv_px.x() = focal_.x() * (x * radial + p1_ * xy2 + p2_ * (s + 2 * x * x)) + centre_.x();
    uv_px.y() = focal_.y() * (y * radial + p1_ * (s + 2 * y * y) + p2_ * xy2) + centre_.y();
    return true;
  }
  [[nodiscard]] bool ProjectFisheye(const Eigen::Vector3f& p_cam, Eigen::Vector2f& uv_px) const {
    const float r = p_cam.head<2>().norm(), theta = std::atan2(r, p_cam.z());
    if (!(theta < limit_) || !(r + std::abs(p_cam.z()) > kNearest_m)) return false;
    const float s = theta * theta;
    const float theta_d = theta * (1 + s * (k_[0] + s * (k_[1] + s * (k_[2] + s * k_[3]))));
    const float scale = r > 0 ? theta_d / r : 0;
    uv_px = focal_.cwiseProduct(scale * p_cam.head<2>()) + centre_;
    return true;
  }

  // Both sphere models: eucm has xi 0, double_sphere beta 1.
  [[nodiscard]] bool ProjectSphere(const Eigen::Vector3f& p_cam, Eigen::Vector2f& uv_px) const {
    const float r2 = p_cam.head<2>().squaredNorm(), d1 = std::sqrt(r2 + p_cam.z() * p_cam.z());
    const float k = xi_ * d1 + p_cam.z(), d2 = std::sqrt(beta_ * r2 + k * k);
    const float divisor = alpha_ * d2 + (1 - alpha_) * k;
    if (!(d1 > kNearest_m) || !(divisor > kLeastDivisor_ratio * d1) || !((1 - alpha_) * d2 + alpha_ * k > 0))
      return false;
    uv_px = focal_.cwiseProduct(p_cam.head<2>()) / divisor + centre_;
    return true;
  }

  static constexpr float kNearest_m = 0.02F;  // nearer than this a point is on the lens

  static constexpr float kLeastDivisor_ratio = 1e-4F;  // of the distance; below, the pixel is far outside, and noise

  bool wide_ = false, sphere_ = false;  // no pinhole; one of the sphere models
  Eigen::Vector2f focal_, centre_;
  std::array<float, 6> k_{};  // pinholes: k1 k2 k3, k4 k5 k6; fisheye: k1 to k4
  float p1_ = 0, p2_ = 0;
  float xi_ = 0, alpha_ = 0, beta_ = 1;  // sphere models
  float limit_ = 0;                      // pinholes: x^2 + y^2; fisheye: the angle from the axis, radians
};

}  // namespace rigcal::cloud
