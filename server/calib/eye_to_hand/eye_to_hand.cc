#include "server/calib/eye_to_hand/eye_to_hand.h"

#include <algorithm>
#include <cmath>

#include "server/calib/camera/projection.h"
#include "server/calib/camera/seen_corners.h"
#include "server/calib/eye_to_hand/exchanged_roles.h"

namespace rigcal::calib {
namespace {

struct CornerErrors {
  double sum_px2 = 0.0;
  std::size_t points = 0;
};

// Of a board that looks alike when turned, the turn that fits best.
CornerErrors ErrorsOf(const BoardView& view, const Target& board, const CameraModel model,
                      const IntrinsicsVector& intrinsics, const Se3& T_cam_board) {
  const std::vector<Eigen::Vector3d> points_board = TargetPoints(board);
  CornerErrors best;
  for (int turn = 0; turn < SymmetryOf(board); ++turn) {
    const SeenCorners seen = SeenIn(view, board, turn);
    CornerErrors errors;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const Eigen::Vector3d p_cam = T_cam_board * points_board[static_cast<std::size_t>(seen.idx[i])];
      const Projection projection = Project(model, intrinsics, p_cam, false);
      if (!projection.in_front) continue;
      errors.sum_px2 += (projection.uv_px - seen.uv_px[i]).squaredNorm();
      ++errors.points;
    }
    const bool better = errors.points > best.points || (errors.points == best.points && errors.sum_px2 < best.sum_px2);
    if (turn == 0 || better) best = errors;
  }
  return best;
}

double RmsOf(const CornerErrors& errors) {
  return std::sqrt(errors.sum_px2 / static_cast<double>(std::max<std::size_t>(1, errors.points)));
}

// Where the robot's poses, as told, have the board's corners in the pictures.
void AddCornerErrors(const HandEyeProblem& problem, const HandEyeEstimate& motion, const CameraEstimate& camera,
                     EyeToHandEstimate& estimate) {
  const HandEyeSide& side = CameraOf(problem);
  const bool camera_is_a = &side == &problem.a;
  const Se3 T_cam_base = camera_is_a ? estimate.T_a_b : estimate.T_a_b.Inverse();
  std::map<CaptureId, Se3> T_base_flange;
  for (const TimedPose& pose : FlangeOf(problem).poses) T_base_flange[pose.capture] = pose.T_world_body;
  CornerErrors all;
  for (const auto& [capture, view] : side.views) {
    if (!motion.residuals.contains(capture) || !T_base_flange.contains(capture)) continue;
    const CornerErrors errors = ErrorsOf(view, *side.board, camera.intrinsics.model, VectorOf(camera.intrinsics),
                                         T_cam_base * T_base_flange.at(capture) * estimate.T_flange_board);
    estimate.rms_px[capture] = RmsOf(errors);
    all.sum_px2 += errors.sum_px2;
    all.points += errors.points;
  }
  estimate.all_rms_px = RmsOf(all);
}

}  // namespace

OrDiagnosis<EyeToHandResult> EstimateEyeToHand(const HandEyeProblem& problem) {
  const ExchangedRoles roles = WithRolesExchanged(problem);
  auto solved = EstimateHandEye(roles.hand_eye);
  if (!solved) return tl::unexpected(OfFlange(solved.error()));
  HandEyeEstimate& motion = solved->estimate;
  EyeToHandResult result;
  EyeToHandEstimate& estimate = result.estimate;
  estimate.T_a_b = EdgePose(roles, motion.T_a_b);
  estimate.T_flange_board = FlangeBoard(roles, motion.T_world_a_world_b);
  estimate.noise_a = motion.noise_a;
  estimate.noise_b = motion.noise_b;
  estimate.motion_rms_m = motion.rms_m;
  estimate.motion_rms_rad = motion.rms_rad;
  estimate.board_scale = motion.board_scale;
  result.camera = std::move(*(roles.tracker_is_a ? solved->camera_b : solved->camera_a));
  AddCornerErrors(problem, motion, result.camera, estimate);
  result.uncertainty = EdgeUncertainty(roles, std::move(solved->uncertainty));
  result.notes = OpenOfFlange(problem, motion.reach);
  for (Diagnosis& note : solved->notes)
    if (note.code != (result.notes.empty() ? std::string() : result.notes.front().code))
      result.notes.push_back(OfFlange(std::move(note)));
  estimate.reach = std::move(motion.reach);
  estimate.unused = std::move(motion.unused);
  return result;
}

}  // namespace rigcal::calib
