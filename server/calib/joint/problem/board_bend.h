// The shapes in which a plate bends and its print is stretched.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "server/model/sensors/target.h"

namespace rigcal::calib::joint {

// Width and height of the plate; of the pattern where the plate's are not known.
[[nodiscard]] inline Eigen::Vector2d PlateSize_m(const Target& target) {
  return target.plate_m.value_or(PatternSize_m(target));
}
// (x^2 - w^2/12, xy, y^2 - h^2/12) / r^2 of a point of the board, x and y from the middle of a plate of w by h, r half
// of its diagonal: a plate that is bent by b = (xx, xy, yy), metres, is b . q deeper there than its plane. Over the
// whole plate each is none in the mean, so that the plane is the one which fits the plate, as a lidar sees it.
[[nodiscard]] inline Eigen::Vector3d BendShape(const Target& target, const Eigen::Vector3d& p_board) {
  const Eigen::Vector2d size_m = PlateSize_m(target);
  const Eigen::Vector3d from_middle = p_board - PlateCentreOf(target);
  const double x = from_middle.x(), y = from_middle.y();
  return Eigen::Vector3d(x * x - size_m.x() * size_m.x() / 12, x * y, y * y - size_m.y() * size_m.y() / 12) /
         (size_m.squaredNorm() / 4);
}

// By how much a point of a print moves in its plane per strain (xx, yy, xy): x from the middle of the plate is longer
// by xx x + xy y, y by xy x + yy y.
[[nodiscard]] inline Eigen::Matrix3d StrainShape(const Eigen::Vector3d& from_middle) {
  Eigen::Matrix3d shape;
  shape << from_middle.x(), 0, from_middle.y(), 0, from_middle.y(), from_middle.x(), 0, 0, 0;
  return shape;
}

// Of each of TargetPoints.
[[nodiscard]] inline std::vector<Eigen::Vector3d> BendShapes(const Target& target) {
  std::vector<Eigen::Vector3d> shapes;
  for (const Eigen::Vector3d& p_board : TargetPoints(target)) shapes.push_back(BendShape(target, p_board));
  return shapes;
}

}  // namespace rigcal::calib::joint
