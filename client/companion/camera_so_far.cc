#include "client/companion/camera_so_far.h"

#include <algorithm>
#include <cmath>

#include "server/calib/camera/camera_start.h"
#include "server/calib/planes/planar_pose.h"

namespace rigcal::companion {
namespace {

using calib::IntrinsicsVector;
using calib::placement::PlannedCamera;

constexpr double kCornerSigmaFirst_px = 0.15, kCornerSigmaMin_px = 0.03;  // before residuals tell; nobody is better
constexpr double kRoughFocal_ratio = 0.8;                                 // of the longer side: a view of 64 degrees

// Of a lens that is estimated: what it may be, before any picture.
IntrinsicsVector OpenLensSigma(const PlannedCamera& camera) {
  IntrinsicsVector sigma = IntrinsicsVector::Zero();
  sigma.head<2>().setConstant(0.3 * camera.intrinsics[0]);
  sigma.segment<2>(2).setConstant(0.1 * std::max(camera.width_px, camera.height_px));
  for (int i = 4; i < calib::IntrinsicsCount(camera.model); ++i) sigma[i] = 0.3;
  if (IsPinhole(camera.model)) sigma.segment<2>(6).setConstant(0.01);  // tangential
  return sigma;
}

void SetLens(const Sensor& sensor, const CameraSoFar& so_far, PlannedCamera& camera) {
  camera.model = sensor.camera_model;
  camera.width_px = so_far.found.width_px, camera.height_px = so_far.found.height_px;
  if (so_far.intrinsics) {
    camera.model = so_far.intrinsics->model;
    camera.intrinsics = calib::VectorOf(*so_far.intrinsics);
    if (camera.width_px == 0) {  // no picture yet: the principal point is near the middle
      camera.width_px = static_cast<int>(std::lround(2 * so_far.intrinsics->cx_px)) + 1;
      camera.height_px = static_cast<int>(std::lround(2 * so_far.intrinsics->cy_px)) + 1;
    }
  } else {
    const double focal_px = kRoughFocal_ratio * std::max(camera.width_px, camera.height_px);
    camera.intrinsics = calib::PlainLens(camera.model, focal_px, camera.width_px, camera.height_px);
  }
  if (!sensor.intrinsics) camera.lens_sigma = OpenLensSigma(camera);
  if (!sensor.intrinsics_sigma) return;
  for (std::size_t i = 0; i < sensor.intrinsics_sigma->size() && i < calib::kIntrinsicsMax; ++i)
    camera.lens_sigma[static_cast<Eigen::Index>(i)] = (*sensor.intrinsics_sigma)[i];
}

// A lens that is not told yet still sees where boards roughly are.
void AppendRoughViews(const Captured& captured, const PlannedCamera& camera, const Target& board,
                      std::map<CaptureId, BoardSeen>& views) {
  const auto pictures = captured.pictures.find(camera.id);
  if (pictures == captured.pictures.end()) return;
  for (const auto& [capture, view] : check::ViewsOf(pictures->second, board.id)) {
    if (views.contains(capture) || !calib::WhyUnusable(view, board).empty()) continue;
    const auto poses =
        calib::PlanarPoses(camera.model, camera.intrinsics, TargetPoints(board), calib::SeenIn(view, board));
    if (!poses.empty()) views[capture] = {poses.front(), view.corner_idx, {poses.begin() + 1, poses.end()}};
  }
}

}  // namespace

std::optional<PlannedCamera> PlannedCameraOf(const SessionHeader& header, const Sensor& sensor,
                                             const CameraSoFar& so_far) {
  PlannedCamera camera;
  camera.id = sensor.id;
  SetLens(sensor, so_far, camera);
  if (camera.width_px <= 0 || camera.height_px <= 0) return std::nullopt;
  camera.corner_sigma_px =
      so_far.corner_sigma_px > 0 ? std::max(so_far.corner_sigma_px, kCornerSigmaMin_px) : kCornerSigmaFirst_px;
  for (std::size_t board = 0; board < header.targets.size(); ++board)
    if (!sensor.sees || *sensor.sees == header.targets[board].id) camera.boards.push_back(board);
  return camera;
}

std::map<CaptureId, BoardSeen> BoardsSeenBy(const Captured& captured, const PlannedCamera& camera) {
  const CameraSoFar& so_far = captured.cameras.at(camera.id);
  std::map<CaptureId, BoardSeen> views;
  if (!so_far.found.board) return views;
  for (const auto& [capture, T_camera_board] : so_far.found.T_cam_board)
    if (const auto idx = so_far.corner_idx.find(capture); idx != so_far.corner_idx.end()) {
      views[capture] = {T_camera_board, idx->second};
      if (const auto others = so_far.other_poses.find(capture); others != so_far.other_poses.end())
        views[capture].other_poses = others->second;
    }
  if (!so_far.intrinsics) AppendRoughViews(captured, camera, *so_far.found.board, views);
  return views;
}

}  // namespace rigcal::companion
