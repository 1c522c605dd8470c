// Which way the surfaces of a scan face.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace rigcal::cloud {

// Coarse: a plane is fitted to each bundle of neighbouring rays.
class Facing {
 public:
  Facing() = default;
  // Steps between the beams; a bundle is some of them wide. `step_up_rad`: between rings, by the sine of a ray's
  // elevation. The same on any number of threads.
  Facing(const std::vector<Eigen::Vector3f>& points_m, float azimuth_step_rad, float elevation_step_rad,
         const std::function<float(float)>& step_up_rad);

  // A unit vector towards the lidar (the origin): of the surface there; where several meet, along the ray; zero where
  // too few points say anything.
  [[nodiscard]] Eigen::Vector3f At(const Eigen::Vector3f& point_m) const {
    return normals_.empty() ? Eigen::Vector3f(Eigen::Vector3f::Zero()) : normals_[IndexOf(point_m)];
  }

 private:
  // Azimuth and elevation along squares instead of circles: bundles of about one size, found without arc tangents.
  [[nodiscard]] std::size_t IndexOf(const Eigen::Vector3f& point_m) const {
    const float level = point_m.head<2>().norm(), across = std::abs(point_m.x()) + std::abs(point_m.y());
    const float share = across > 0 ? point_m.y() / across : 0, height = level + std::abs(point_m.z());
    const float around = point_m.x() < 0 ? 3 - share : 1 + share;  // 0 to 4
    const float up = 1 + (height > 0 ? point_m.z() / height : 0);  // 0 to 2
    const int column = std::min(static_cast<int>(around * per_quarter_), columns_ - 1);
    const int row = std::min(static_cast<int>(up * per_quarter_), rows_ - 1);
    return static_cast<std::size_t>(row * columns_ + column);
  }

  int columns_ = 0, rows_ = 0;
  float per_quarter_ = 1;  // bundles in a quarter of the way round
  std::vector<Eigen::Vector3f> normals_;
};

}  // namespace rigcal::cloud
