// Which patch of each cloud is the board that the camera sees: the pose that the most captures agree on decides.
#pragma once

#include <optional>
#include <vector>

#include "server/math/se3.h"

namespace rigcal::calib {

// A board as one sensor sees it.
struct BoardPlane {
  Eigen::Vector3d normal;  // unit, towards the sensor
  Eigen::Vector3d centre_m;
};

// What one capture allows: the board's poses in the picture (more than one where a plane seen small is ambiguous), the
// cloud's patches.
struct PlaneCandidates {
  std::vector<BoardPlane> camera, lidar;
};

struct PlaneMatch {
  std::size_t camera_idx = 0, lidar_idx = 0;
};

struct PatchChoice {
  Se3 T_cam_lidar;                                 // from normals and centres (Procrustes, det +1): a start
  std::vector<std::optional<PlaneMatch>> matches;  // per capture; empty: nothing in it agrees
  std::size_t supporters = 0;                      // captures that agree
  // The best pose that is clearly another one, and how many captures agree with it.
  std::optional<Se3> other;
  std::size_t other_supporters = 0;
  bool settled_by_nominal = false;  // the nominal pose is near this one and clearly farther from the other
};

// Empty if fewer than two captures agree on any pose. `nominal` is tried as well; where two poses are supported almost
// equally the one nearer to it is taken, and it settles the matter if it is near (45 deg and 1 m) and the other one
// twice as far.
[[nodiscard]] std::optional<PatchChoice> ChoosePatches(const std::vector<PlaneCandidates>& captures,
                                                       const std::optional<Se3>& nominal);
// The match of one capture that agrees best with T_cam_lidar; empty: none agrees.
[[nodiscard]] std::optional<PlaneMatch> BestMatch(const PlaneCandidates& capture, const Se3& T_cam_lidar);

}  // namespace rigcal::calib
