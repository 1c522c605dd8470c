// The usable points of a cloud as rays from the sensor, in an order that makes every prefix a fair sample.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "server/model/sensors/cloud.h"

namespace rigcal::detect {

// Points at 0.1 to 200 m, at most kRaysMax of them (a fair sample of more), shuffled with a fixed seed; two indices
// over them. All in the sensor's frame.
class CloudRays {
 public:
  static constexpr std::size_t kRaysMax = 250'000;
  static constexpr float kRangeMin_m = 0.1f, kRangeMax_m = 200.0f;

  // ball_m: the radius of the balls that will be asked for, > 0.
  CloudRays(const Cloud& cloud, double ball_m);

  std::vector<Eigen::Vector3f> points_m;
  std::vector<Eigen::Vector3f> directions;  // unit, of the points

  // Indices of about `budget` points (a fair sample) nearer than the ball's radius to `centre_m`.
  void InBall(const Eigen::Vector3f& centre_m, std::size_t budget, std::vector<std::uint32_t>& found) const;
  // Indices of about `budget` rays (a fair sample) within the angle of `axis` (unit).
  void InCone(const Eigen::Vector3f& axis, double angle_rad, std::size_t budget,
              std::vector<std::uint32_t>& found) const;
  // Whether beams go there at all, as far as the elevations and azimuths of all points tell.
  bool Sees(const Eigen::Vector3d& direction) const;

 private:
  void IndexField();
  void IndexDirections();
  void IndexVoxels();

  double ball_m_;
  float height_min_ = 1, height_max_ = -1;                             // sines of elevation
  std::vector<bool> azimuths_;                                         // by degree, widened
  std::vector<std::uint32_t> cone_start_, cone_members_, slab_start_;  // of the occupied cells, in order of x
  std::vector<Eigen::Vector3f> cone_middles_;
  std::vector<std::uint64_t> voxel_keys_;
  std::vector<std::uint32_t> voxel_start_, voxel_members_;
};

}  // namespace rigcal::detect
