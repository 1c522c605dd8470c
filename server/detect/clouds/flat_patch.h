// Planes through noisy points, and a cloud's rays as they pierce such a plane.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "server/detect/clouds/cloud_rays.h"

namespace rigcal::detect {

// normal . p + offset_m = 0 with a unit normal towards the sensor: offset_m is the sensor's distance, >= 0.
struct FittedPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double offset_m = 0.0;
  double sigma_m = 0.0;  // robust, of the points about the plane
  Eigen::Vector3d centroid_m = Eigen::Vector3d::Zero();

  // With its sign: positive on the sensor's side.
  [[nodiscard]] double Distance_m(const Eigen::Vector3d& point_m) const { return normal.dot(point_m) + offset_m; }
  // How far a point may lie off and still be on the plane.
  [[nodiscard]] double Tolerance_m() const;
};

// Least squares with outliers weighed down (Tukey). Nothing if the points span no plane: fewer than 6, or within
// `width_min_m` of one line.
[[nodiscard]] std::optional<FittedPlane> FitPlane(const std::vector<Eigen::Vector3d>& points_m, double width_min_m,
                                                  int rounds = 5);

// What a ray says of the place where it pierces the plane.
enum class Evidence : std::int8_t {
  kOn,
  kBehind,
  kFront
};  // a surface there; nothing there; hidden by something nearer
struct Piercing {
  Eigen::Vector2f uv_m;  // on the plane, about its frame's origin
  Evidence evidence;
  std::uint32_t ray;  // its index among the rays
};

// Right-handed frame on a plane: u level if the plane is not, v up, normal towards the sensor.
struct PlaneFrame {
  Eigen::Vector3d origin_m, u, v;

  // From the plane's coordinates to the sensor's frame; and back, of a point's foot on the plane.
  [[nodiscard]] Eigen::Vector3d At(const Eigen::Vector2d& uv_m) const { return origin_m + u * uv_m.x() + v * uv_m.y(); }
  [[nodiscard]] Eigen::Vector2d Of(const Eigen::Vector3d& point_m) const {
    return {u.dot(point_m - origin_m), v.dot(point_m - origin_m)};
  }
};
// With its origin at the foot of `near_m`.
[[nodiscard]] PlaneFrame FrameOn(const FittedPlane& plane, const Eigen::Vector3d& near_m);

// About `budget` rays that pierce the plane within `radius_m` of the frame's origin.
[[nodiscard]] std::vector<Piercing> Pierce(const CloudRays& rays, const FittedPlane& plane, const PlaneFrame& frame,
                                           double radius_m, std::size_t budget);

}  // namespace rigcal::detect
