// Starting values of one camera's intrinsics from its views.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "server/base/result.h"
#include "server/calib/core/joint_problem.h"

namespace rigcal::calib {

// All views of one camera: pictures of one size.
struct CameraViews {
  int width_px = 0, height_px = 0;
  std::vector<Eigen::Vector3d> corners_board;
  std::vector<SeenCorners> seen;
  CameraModel model = CameraModel::kPinholeRadtan;
};

// The first so many of `views`, evenly spread.
[[nodiscard]] CameraViews Spread(const CameraViews& views, std::size_t count_max);
// The camera alone, as camera a; no view is left away.
[[nodiscard]] JointProblem OneCamera(const CameraViews& views, bool estimate);

// The lens that bends least of its model, principal point in the middle: pinholes and fisheyes without distortion,
// sphere models with alpha 0.5, beta 1, xi -0.2. `focal_px` on the axis.
[[nodiscard]] IntrinsicsVector PlainLens(CameraModel model, double focal_px, int width_px, int height_px);

// A plain lens. Pinhole: focal lengths from vanishing points; where the views do not tell them (no tilt), the picture's
// longer side. Others: fields of view are tried. Always usable.
[[nodiscard]] IntrinsicsVector RoughIntrinsics(const CameraViews& views);
// The rough intrinsics refined together with the board poses, a pinhole with two radial terms (Zhang 2000), on at most
// some tens of the views, evenly spread; every corner of the views can be seen. Rational: those, or what a fisheye
// makes of the views where boards reproject better with it. Fisheye and sphere models with all their terms.
[[nodiscard]] Result<IntrinsicsVector> StartIntrinsics(const CameraViews& views);

// How far from the axis the outermost corner is, as the distortion's series takes it: the radius at depth 1 (pinhole)
// or the angle in radians (others). Corners that the lens cannot see do not count.
[[nodiscard]] double SeenReach(CameraModel model, const IntrinsicsVector& intrinsics, const CameraViews& views);

}  // namespace rigcal::calib
