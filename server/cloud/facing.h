// Which way the surfaces of a scan face.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

namespace rigcal::cloud {

// Coarse: a plane is fitted to each bundle of neighbouring rays.
class Facing {
 public:
  Facing() = default;
  // `step_rad`: between the beams; a bundle is some steps wide. The same on any number of threads.
  Facing(const std::vector<Eigen::Vector3f>& points_m, float step_rad);

  // A unit vector towards the lidar (the origin): of the surface there; where several meet, along the ray; zero where
  // too few points say anything.
  [[nodiscard]] Eigen::Vector3f At(const Eigen::Vector3f& point_m) const {
    return normals_.empty() ? Eigen::Vector3f(Eigen::Vector3f::Zero()) : normals_[IndexOf(point_m)];
  }

 private:
  [[nodiscard]] std::size_t IndexOf(const Eigen::Vector3f& point_m) const;

  int columns_ = 0, rows_ = 0;
  float size_rad_ = 1;
  std::vector<Eigen::Vector3f> normals_;
};

}  // namespace rigcal::cloud
