// Point to plane between a camera and a lidar (paper, section III-A: 3D lidar to camera; Unnikrishnan & Hebert 2005): a
// lidar's points of a board lie on the plane that the camera sees, n_c^T (R p_l + t) = d_c. T_cam_lidar and the boards'
// poses at once; the boards' poses carry what the pictures say about them, so that n_c and d_c are not taken as exact.
#pragma once

#include <optional>
#include <vector>

#include "server/base/result.h"
#include "server/calib/planes/plane_moments.h"
#include "server/math/se3.h"

namespace rigcal::calib {

struct PlaneCapture {
  Se3 T_cam_board;                                 // as the picture alone says
  Matrix6d camera_information = Matrix6d::Zero();  // of that, right tangent at the board; positive definite
  PlaneMoments moments;                            // of the board's points
  double factor = 1.0;  // on the moments: less than 1 where points of one capture share errors
};

// A direction of the translation that the boards' normals do not tell. Loosely held where a drawing has it, so that
// noise does not carry it away; whoever holds it claims nothing along it.
struct HeldDirection {
  Eigen::Vector3d axis_cam = Eigen::Vector3d::UnitZ();  // unit
  double at_m = 0.0;                                    // of the lidar along it, in the camera's frame
};

struct PlaneState {
  Se3 T_cam_lidar;
  double range_bias_m = 0.0;     // ranges are too short by this much; 0 unless estimated
  std::vector<Se3> T_cam_board;  // one per capture
  std::optional<HeldDirection> held;
};

struct PlaneSolution {
  PlaneState state;
  Matrix7d information = Matrix7d::Zero();  // of [xi of T_cam_lidar, range bias], board poses eliminated
  double cost = 0.0;                        // at the minimum
  int iterations = 0;
};

// min sum factor g^T M g + delta^T information delta (Gauss-Newton with halved steps, boards eliminated). g is the
// board's plane z = 0 in the lidar's frame (plane_moments.h). Without `estimate_bias` the bias stays as it is and the
// information's last row and column are zero. Fails where a direction is not observable or nothing converges. Done as
// well where a full step loses as many weighted squares as linear residuals would, to `linear_ratio` of those that
// moving the lidar loses.
[[nodiscard]] Result<PlaneSolution> SolvePlanes(const std::vector<PlaneCapture>& captures, const PlaneState& start,
                                                bool estimate_bias, double linear_ratio = 0.0);
// How the solution moves, right tangent at the lidar, when what is held is held farther along: that much and no more is
// left open by it. Normals that lie nearly in one plane turn the lidar a little as well. Something must be held.
[[nodiscard]] Vector6d FollowingHeld(const PlaneSolution& solution);
// The board's plane in the lidar's frame, as g.
[[nodiscard]] Vector7d PlaneInLidar(const PlaneState& state, std::size_t capture_idx);
// Mean distance of the capture's points from the board, metres; positive: the points lie behind it (farther away).
[[nodiscard]] double MeanDistance_m(const PlaneCapture& capture, const Vector7d& g);

// Its standard deviation: noise of the points, and what the picture leaves open of the board.
[[nodiscard]] double MeanDistanceSigma_m(const PlaneCapture& capture, const PlaneState& state, std::size_t capture_idx);

}  // namespace rigcal::calib
