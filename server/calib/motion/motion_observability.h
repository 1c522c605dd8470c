// Which directions of T_a_b a motion tells. A rotation away from a common axis counts only where it is beyond the
// noise: singular values alone would take noise for information.
#pragma once

#include <string>
#include <vector>

#include "server/calib/core/directions.h"
#include "server/math/se3.h"

namespace rigcal::calib {

enum class MotionKind {
  kGeneral,     // turned about different axes: everything is told
  kOneAxis,     // turned about one axis, as on a flat floor: nothing along it
  kOnTheSpot,   // turned about one fixed line: nothing along it, nor about it
  kNoRotation,  // only moved: no translation
  kOneLine,     // only moved, along one line: nothing about it either
  kStill,       // nothing at all
};

struct MotionNoise {
  double translation_m = 0.0, rotation_rad = 0.0;  // one sigma per axis of what one pose is known to
  double noises = 3.0;                             // a rotation or a way counts from so many of its noise on
};

struct MotionReach {
  MotionKind kind = MotionKind::kGeneral;
  Eigen::Vector3d axis_a = Eigen::Vector3d::UnitZ();    // unit, in frame a: the common axis, or the line
  Eigen::Vector3d point_a_m = Eigen::Vector3d::Zero();  // of kOnTheSpot: on the axis
  double tilt_rad = 0.0;                                // rms rotation away from the axis
  double tilt_noise_rad = 0.0;
  double turn_rad = 0.0;  // rms rotation about it
  double travel_m = 0.0;  // rms way of the point of the body that moves least across the axis
  // Orthonormal columns, right tangent at b: what is open, and what is not.
  Directions open, free;
};

// `T_world_a`: poses of the body; X = T_a_b.
[[nodiscard]] MotionReach ObservableByMotion(const std::vector<Se3>& T_world_a, const Se3& X, const MotionNoise& noise);

// Of a motion that leaves directions open by itself: "planar_motion", "turning_on_the_spot", "pure_translation" or
// "straight_line"; after "was" or "were"; how many directions; what tells them. Else no code. `axis`: in words.
struct MotionWords {
  std::string code, moved;
  std::size_t open = 0;
  std::string cure;
};
// A general motion has no code, and neither has one that stands still.
[[nodiscard]] MotionWords WordsOf(const MotionReach& motion, const std::string& axis);

}  // namespace rigcal::calib
