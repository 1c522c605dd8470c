#include "server/calib/camera/focal_trials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "server/calib/planes/planar_pose.h"

namespace rigcal::calib {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();
constexpr std::array<double, 9> kFocals_ratio = {0.15, 0.24, 0.38, 0.6, 0.95,
                                                 1.5,  2.4,  3.8,  6.0};  // of the longer side
constexpr double kStep_ratio = 1.6;
constexpr int kHalvings = 3;  // of the logarithm of that step, to both sides of the best
constexpr std::size_t kViewsTried = 12;
constexpr int kRounds = 2;  // poses of boards are chosen anew once the distortion is known

bool PlaceAll(const JointProblem& joint, JointState& state) {
  state.T_a_board.resize(joint.captures.size());
  for (std::size_t k = 0; k < joint.captures.size(); ++k) {
    const PoseChoice choice = ChoosePose(joint, state, k, AllowedPoses(joint, state, k));
    if (!std::isfinite(choice.ssr_px2)) return false;
    state.T_a_board[k] = choice.T_a_board;
  }
  return true;
}

double RmsOf_px(const JointProblem& joint, const JointState& state) {
  double ssr_px2 = 0;
  for (std::size_t k = 0; k < joint.captures.size(); ++k) ssr_px2 += ErrorOf(joint, state, k).a_px2;
  return std::sqrt(2 * ssr_px2 / ResidualCount(joint));
}

double RmsAtFocal_px(const CameraViews& views, double focal_px) {
  JointProblem joint = OneCamera(views, true);
  joint.a.held = {0};  // the other one follows: pixels need not be square
  JointState state;
  state.intrinsics_a.head<4>() << focal_px, focal_px, 0.5 * (views.width_px - 1), 0.5 * (views.height_px - 1);
  double least_px = kNone;
  for (int round = 0; round < kRounds && PlaceAll(joint, state); ++round) {
    auto solved = SolveJoint(joint, state);
    if (!solved) break;
    state = std::move(solved->state);
    least_px = std::min(least_px, RmsOf_px(joint, state));
  }
  return least_px;
}

}  // namespace

double LeastRmsOverFocals_px(const CameraViews& views) {
  const CameraViews tried = Spread(views, kViewsTried);
  double least_px = kNone, best_px = 0;
  const auto look = [&](double focal_px) {
    const double rms_px = RmsAtFocal_px(tried, focal_px);
    if (rms_px < least_px) least_px = rms_px, best_px = focal_px;
  };
  for (const double ratio : kFocals_ratio) look(ratio * std::max(views.width_px, views.height_px));
  double step_ratio = kStep_ratio;
  for (int halving = 0; halving < kHalvings && std::isfinite(least_px); ++halving) {
    step_ratio = std::sqrt(step_ratio);
    const double middle_px = best_px;
    look(middle_px / step_ratio);
    look(middle_px * step_ratio);
  }
  return least_px;
}

}  // namespace rigcal::calib
