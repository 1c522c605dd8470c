// What detection finds in one picture or one cloud.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "server/base/ids.h"

namespace rigcal {

// A target in one picture. `corner_idx` and `corners_px` run side by side; indices are those of TargetPoints(),
// ascending. A checkerboard is seen whole or not at all; other targets may be seen in part. A target with SymmetryOf()
// > 1 is in one of its orientations: which one, only other sensors can tell.
struct BoardView {
  bool found = false;
  std::string why_not;  // in words, if not found
  TargetId target;
  int image_width_px = 0, image_height_px = 0;
  std::vector<Eigen::Vector2d> corners_px;
  std::vector<int> corner_idx = {};
  friend bool operator==(const BoardView&, const BoardView&) = default;
};

// The same with the picture of it, encoded, for reports.
struct AnnotatedView {
  BoardView view;
  std::string picture;  // JPEG bytes; empty if the input could not be decoded
};

// A flat patch of a cloud that may be the target's plate. Everything in the lidar's frame.
struct PlanePatch {
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();  // of the plate as fitted to the patch's outline
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();   // unit, towards the sensor
  Eigen::Vector2d extent_m = Eigen::Vector2d::Zero();  // longer and shorter side of the patch as seen
  double rms_m = 0.0;                                  // distance of the points from the plane
  double score = 0.0;                                  // 1: outline and size as the plate's; 0: not at all
  std::vector<Eigen::Vector3f> points_m;               // of the patch
};

// A target in one cloud: every patch that could be its plate, the best first.
struct CloudView {
  bool found = false;   // at least one candidate
  std::string why_not;  // in words, if not found
  TargetId target;
  std::size_t points = 0;  // of the cloud
  std::vector<PlanePatch> candidates;
  std::string note = {};  // what is odd about its points, in words
};

// The same with the picture of it (the cloud as a range image, candidates outlined), encoded, for reports.
struct AnnotatedCloud {
  CloudView view;
  std::string picture;  // JPEG bytes; empty if the input could not be decoded
};

}  // namespace rigcal
