#include "server/calib/pose_choice.h"

#include <cmath>

#include "server/calib/camera_start.h"

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
  if (!capture.a_px.empty()) allowed = PlanarPoses(state.intrinsics_a, problem.corners_board, capture.a_px);
  if (capture.b_px.empty()) return allowed;
  for (const Se3& T_b_board : PlanarPoses(state.intrinsics_b, problem.corners_board, capture.b_px))
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
    const Se3 refined = SolveBoardPose(problem, state, capture_idx, candidate);
    minima.push_back({refined, ErrorAt(problem, state, capture_idx, refined)});
    if (minima.back().ssr_px2 < choice.ssr_px2) choice.T_a_board = refined, choice.ssr_px2 = minima.back().ssr_px2;
  }
  for (const Minimum& minimum : minima)
    if (AngleBetween_rad(minimum.T_a_board, choice.T_a_board) > kSameMinimum_rad)
      choice.other_ssr_px2 = std::min(choice.other_ssr_px2, minimum.ssr_px2);
  return choice;
}

}  // namespace rigcal::calib
