#include "server/calib/planes/pose_choice.h"

#include <cmath>

#include "server/calib/planes/planar_pose.h"

namespace rigcal::calib {
namespace {

constexpr double kSameMinimum_rad = 0.0175;

double AngleBetween_rad(const Se3& T, const Se3& S) { return (T.Inverse() * S).Log().tail<3>().norm(); }

double ErrorAt(const JointProblem& problem, JointState state, std::size_t capture_idx, const Se3& T_a_board) {
  state.T_a_board[capture_idx] = T_a_board;
  const CaptureError error = ErrorOf(problem, state, capture_idx);
  return error.a_px2 + error.b_px2;
}

}  // namespace

std::vector<Se3> AllowedPoses(const JointProblem& problem, const JointState& state, std::size_t capture_idx) {
  const JointCapture& capture = problem.captures[capture_idx];
  std::vector<Se3> allowed;
  if (!capture.a.empty()) allowed = PlanarPoses(problem.model_a, state.intrinsics_a, problem.corners_board, capture.a);
  if (capture.b.empty()) return allowed;
  for (const Se3& T_b_board : PlanarPoses(problem.model_b, state.intrinsics_b, problem.corners_board, capture.b))
    allowed.push_back(state.T_a_b * T_b_board);
  return allowed;
}

PoseChoice ChoosePose(const JointProblem& problem, const JointState& state, std::size_t capture_idx,
                      const std::vector<Se3>& candidates) {
  struct Minimum {
    Se3 T_a_board;
    double ssr_px2;
  };
  std::vector<Minimum> minima;
  PoseChoice choice;
  for (const Se3& candidate : candidates) {
    if (!std::isfinite(ErrorAt(problem, state, capture_idx, candidate))) continue;
    const Se3 refined = SolveBoardPose(problem, state, capture_idx, candidate);
    minima.push_back({refined, ErrorAt(problem, state, capture_idx, refined)});
    if (minima.back().ssr_px2 < choice.ssr_px2) choice.T_a_board = refined, choice.ssr_px2 = minima.back().ssr_px2;
  }
  for (const Minimum& minimum : minima)
    if (minimum.ssr_px2 < choice.other_ssr_px2 &&
        AngleBetween_rad(minimum.T_a_board, choice.T_a_board) > kSameMinimum_rad)
      choice.T_a_board_other = minimum.T_a_board, choice.other_ssr_px2 = minimum.ssr_px2;
  return choice;
}

}  // namespace rigcal::calib
