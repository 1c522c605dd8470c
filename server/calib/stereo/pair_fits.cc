#include "server/calib/camera/camera_fit.h"
#include "server/calib/lidar_camera/lidar_camera.h"
#include "server/calib/motion/hand_eye.h"
#include "server/calib/stereo/stereo.h"

namespace rigcal::calib {
namespace {

std::map<CaptureId, Se3> BoardsOfB(const StereoEstimate& estimate) {
  std::map<CaptureId, Se3> T_b_board;
  for (const auto& [capture, T_a_board] : estimate.T_a_board) T_b_board[capture] = estimate.T_a_b.Inverse() * T_a_board;
  return T_b_board;
}

CameraFit FitOrSeen(const CameraProblem& problem, const CameraEstimate* camera) {
  return camera != nullptr ? FitOf(problem, camera->intrinsics, camera->T_cam_board) : SeenBy(problem);
}

void AddSide(const HandEyeSide& side, const CameraEstimate* camera, std::vector<CameraFit>& fits) {
  if (side.sensor.kind == SensorKind::kCamera && side.board)
    fits.push_back(FitOrSeen({side.sensor, *side.board, side.views}, camera));
}

}  // namespace

CameraProblem CameraOf(const StereoProblem& problem, std::optional<BoardView> StereoCapture::*camera) {
  CameraProblem one{camera == &StereoCapture::a ? problem.camera_a : problem.camera_b, problem.board, {}};
  for (const StereoCapture& capture : problem.captures)
    if (capture.*camera) one.views.emplace_back(capture.capture, *(capture.*camera));
  return one;
}

std::vector<CameraFit> FitsOf(const StereoProblem& problem, const StereoEstimate* estimate) {
  const CameraProblem a = CameraOf(problem, &StereoCapture::a), b = CameraOf(problem, &StereoCapture::b);
  if (estimate == nullptr) return {SeenBy(a), SeenBy(b)};
  return {FitOf(a, estimate->intrinsics_a, estimate->T_a_board),
          FitOf(b, estimate->intrinsics_b, BoardsOfB(*estimate), estimate->turn_b)};
}

std::vector<CameraFit> FitsOf(const LidarCameraProblem& problem, const CameraEstimate* camera) {
  CameraProblem one{problem.camera, problem.board, {}};
  for (const LidarCameraCapture& capture : problem.captures)
    if (capture.view) one.views.emplace_back(capture.capture, *capture.view);
  return {FitOrSeen(one, camera)};
}

std::vector<CameraFit> FitsOf(const HandEyeProblem& problem, const CameraEstimate* camera_a,
                              const CameraEstimate* camera_b) {
  std::vector<CameraFit> fits;
  AddSide(problem.a, camera_a, fits);
  AddSide(problem.b, camera_b, fits);
  return fits;
}

}  // namespace rigcal::calib
