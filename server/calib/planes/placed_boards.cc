#include "server/calib/planes/placed_boards.h"

#include <algorithm>

#include "server/calib/planes/planar_pose.h"

namespace rigcal::calib {

PlacedBoards PlaceBoards(const CameraViews& views, const IntrinsicsVector& intrinsics) {
  const JointProblem all = OneCamera(views, true);
  PlacedBoards placed{all, {}, 0};
  placed.joint.captures.clear();
  JointState state;
  state.intrinsics_a = placed.state.intrinsics_a = intrinsics;
  state.T_a_board.resize(all.captures.size());
  // No view counts more than one that is off by a tenth of the picture.
  const double worst_px = 0.1 * std::max(views.width_px, views.height_px);
  for (std::size_t k = 0; k < all.captures.size(); ++k) {
    const PoseChoice choice = ChoosePose(all, state, k, AllowedPoses(all, state, k));
    const double limit_px2 = worst_px * worst_px * static_cast<double>(all.captures[k].a.size());
    placed.cost_px2 += std::min(choice.ssr_px2, limit_px2);
    if (!(choice.ssr_px2 < limit_px2)) continue;
    placed.joint.captures.push_back(all.captures[k]);
    placed.state.T_a_board.push_back(choice.T_a_board);
  }
  return placed;
}

}  // namespace rigcal::calib
