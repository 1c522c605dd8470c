// Ellipses in a picture: what circles of a board may look like.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "server/detect/pictures/grey_image.h"

namespace rigcal::detect {

// A spot that is darker, or lighter, than what is around it. Its edge is at centre_px + axes_px * (cos t, sin t).
struct Ellipse {
  Eigen::Vector2d centre_px = Eigen::Vector2d::Zero();
  Eigen::Matrix2d axes_px = Eigen::Matrix2d::Identity();  // symmetric, positive definite
  bool is_dark = true;
  // A place in the picture, in the frame in which the ellipse is the unit circle.
  [[nodiscard]] Eigen::Vector2d Whitened(const Eigen::Vector2d& at_px) const;
  // Half of the larger, and of the smaller axis.
  [[nodiscard]] double Major_px() const;
  [[nodiscard]] double Minor_px() const;
};

// To about a pixel; one for each spot, in the order of rows of pixels. Spots that touch the picture's border are left
// out. Throws what OpenCV throws.
[[nodiscard]] std::vector<Ellipse> FindEllipses(const GreyImage& image);

// Area, centroid and second moments (over the area) of a polygon whose corners go round once.
struct PolygonMoments {
  double area = 0.0;  // above 0
  Eigen::Vector2d centroid = Eigen::Vector2d::Zero();
  Eigen::Matrix2d second = Eigen::Matrix2d::Identity();  // about the centroid
};
[[nodiscard]] PolygonMoments MomentsOf(const std::vector<Eigen::Vector2d>& polygon);
// The axes of the ellipse that has them: a symmetric root, doubled. Zero where they are of no ellipse.
[[nodiscard]] Eigen::Matrix2d AxesOf(const Eigen::Matrix2d& second_moments);

}  // namespace rigcal::detect
