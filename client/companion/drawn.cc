#include "client/companion/drawn.h"

#include <array>

namespace rigcal::companion {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kPiecesOfSide = 8;
constexpr double kViewDrawn_m = 0.3;

std::array<Vector3d, 4> CornersOf(const Target& board) {
  const Vector3d middle = CentreOf(board);
  const Vector2d half = PatternSize_m(board) / 2;
  return {middle + Vector3d(-half.x(), -half.y(), 0), middle + Vector3d(half.x(), -half.y(), 0),
          middle + Vector3d(half.x(), half.y(), 0), middle + Vector3d(-half.x(), half.y(), 0)};
}

Vector2d OnFloor(const Vector3d& p_ref) { return {p_ref.x(), p_ref.z()}; }

FromAbove::Camera ViewOf(const calib::placement::PlannedCamera& camera) {
  FromAbove::Camera drawn{camera.id, {OnFloor(camera.T_ref_camera.p_m)}};
  for (const double u_px : {0.0, camera.width_px - 1.0})
    if (const auto ray = calib::Unproject(camera.model, camera.intrinsics, {u_px, 0.5 * (camera.height_px - 1)}))
      drawn.view_m.push_back(OnFloor(camera.T_ref_camera * Vector3d(kViewDrawn_m * *ray)));
  return drawn;
}

}  // namespace

std::vector<Vector2d> OutlineInPicture(const calib::placement::PlannedCamera& camera, const Target& board,
                                       const Se3& T_camera_board) {
  const std::array<Vector3d, 4> corners = CornersOf(board);
  std::vector<Vector2d> outline_px;
  for (std::size_t side = 0; side < 4; ++side)
    for (int piece = 0; piece < kPiecesOfSide; ++piece) {
      const double along = static_cast<double>(piece) / kPiecesOfSide;
      const Vector3d point = (1 - along) * corners[side] + along * corners[(side + 1) % 4];
      const auto seen = calib::Project(camera.model, camera.intrinsics, T_camera_board * point, false);
      if (seen.in_front) outline_px.push_back(seen.uv_px);
    }
  return outline_px;
}

FromAbove DrawFromAbove(const calib::placement::PlannedRig& rig, const calib::placement::NextPlacement& next) {
  FromAbove above;
  for (const calib::placement::PlannedCamera& camera : rig.cameras) above.cameras.push_back(ViewOf(camera));
  const Se3 T_ref_board = rig.cameras[next.camera].T_ref_camera * next.T_camera_board;
  for (const Vector3d& corner : CornersOf(rig.boards[next.board]))
    above.board_m.push_back(OnFloor(T_ref_board * corner));
  return above;
}

}  // namespace rigcal::companion
