#include "server/calib/placement/stand.h"

#include <algorithm>
#include <cmath>

namespace rigcal::calib::placement {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kSameSight_rad = 0.1, kSameDistance_ratio = 1.15, kSameTilt_rad = 0.17, kSameTurn_rad = 0.5;

// Of a board that faces the camera along `ray`: z along the ray, x level in the picture.
Matrix3d Facing(const Vector3d& ray) {
  Matrix3d R;
  R.col(2) = ray;
  R.col(0) = Vector3d::UnitY().cross(ray).normalized();
  R.col(1) = ray.cross(R.col(0));
  return R;
}

Vector3d RayOf(const Stand& stand) {
  return {std::cos(stand.up_rad) * std::sin(stand.right_rad), -std::sin(stand.up_rad),
          std::cos(stand.up_rad) * std::cos(stand.right_rad)};
}

Matrix3d TiltOf(const Stand& stand) {
  return (Eigen::AngleAxisd(stand.tilt_right_rad, Vector3d::UnitY()) *
          Eigen::AngleAxisd(stand.tilt_up_rad, Vector3d::UnitX()))
      .toRotationMatrix();
}

}  // namespace

Se3 PoseOf(const Stand& stand, const Target& board) {
  const Vector3d ray = RayOf(stand);
  const Eigen::AngleAxisd turn(stand.turned_rad, Vector3d::UnitZ());
  const Eigen::Quaterniond q(Matrix3d(Facing(ray) * TiltOf(stand) * turn.toRotationMatrix()));
  return Se3{stand.distance_m * ray - q * CentreOf(board), q}.Normalized();
}

Stand StandOf(const Se3& T_camera_board, const Target& board) {
  const Vector3d middle = T_camera_board * CentreOf(board);
  Stand stand;
  stand.distance_m = middle.norm();
  const Vector3d ray = middle / std::max(stand.distance_m, 1e-12);
  stand.right_rad = std::atan2(ray.x(), ray.z());
  stand.up_rad = std::asin(std::clamp(-ray.y(), -1.0, 1.0));
  const Matrix3d seen = Facing(ray).transpose() * T_camera_board.R();
  stand.tilt_right_rad = std::atan2(seen(0, 2), seen(2, 2));
  stand.tilt_up_rad = std::asin(std::clamp(-seen(1, 2), -1.0, 1.0));
  const Vector3d across = TiltOf(stand).transpose() * seen.col(0);
  stand.turned_rad = std::atan2(across.y(), across.x());
  return stand;
}

double TurnedAside_rad(const Stand& stand) {
  return std::atan2(std::abs(std::sin(stand.turned_rad)), std::abs(std::cos(stand.turned_rad)));
}

bool AreAlike(const Stand& a, const Stand& b) {
  const double sight_rad = std::hypot(a.right_rad - b.right_rad, a.up_rad - b.up_rad);
  const double tilt_rad = std::hypot(a.tilt_right_rad - b.tilt_right_rad, a.tilt_up_rad - b.tilt_up_rad);
  const double farther = std::max(a.distance_m, b.distance_m) / std::min(a.distance_m, b.distance_m);
  const double turn_rad = TurnedAside_rad({.turned_rad = a.turned_rad - b.turned_rad});
  return sight_rad < kSameSight_rad && tilt_rad < kSameTilt_rad && farther < kSameDistance_ratio &&
         turn_rad < kSameTurn_rad;
}

}  // namespace rigcal::calib::placement
