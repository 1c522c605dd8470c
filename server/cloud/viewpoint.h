// From where a cloud is looked at: front, top, oblique.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace rigcal::cloud {

// How the lidar stands: unit vectors in its frame, at right angles.
struct Stand {
  Eigen::Vector3f up = Eigen::Vector3f::UnitZ(), forward = Eigen::Vector3f::UnitX();
};
// Of two directions that need be neither unit nor at right angles; the lidar's own z and x where they say nothing.
[[nodiscard]] Stand StandOf(const Eigen::Vector3d& up, const Eigen::Vector3d& forward);

// The same, turned about its up to where most of the points lie in the front view, unless it shows nearly as many as it
// is: for cameras that look all around, where no direction is ahead.
[[nodiscard]] Stand FacingMost(const Stand& stand, const std::vector<Eigen::Vector3f>& points_m);

enum class Angle { kFront, kTop, kOblique };

struct Viewpoint {
  Eigen::Matrix3f R_view_lidar;                      // x right, y down, z into the picture
  bool perspective = false;                          // from the lidar itself; else parallel
  float scale_px = 1;                                // per metre, or per unit of x / z
  Eigen::Vector2f middle = Eigen::Vector2f::Zero();  // of the picture: metres, or x / z
  float reach_m = 10;                                // what the picture is made for: most points lie nearer

  // Place in the picture (width x height), and the depth along the view.
  [[nodiscard]] Eigen::Vector3f Place(const Eigen::Vector3f& p_view, int width_px, int height_px) const {
    const float over = perspective ? 1 / p_view.z() : 1;
    return {(p_view.x() * over - middle.x()) * scale_px + 0.5F * static_cast<float>(width_px),
            (p_view.y() * over - middle.y()) * scale_px + 0.5F * static_cast<float>(height_px), p_view.z()};
  }
};

// Fitted to these points: the far few do not make the rest small.
[[nodiscard]] Viewpoint ViewpointOf(const std::vector<Eigen::Vector3f>& points_m, const Stand& stand, Angle angle,
                                    int width_px, int height_px);

}  // namespace rigcal::cloud
