#include "client/companion/captured.h"

#include <cmath>

#include "client/check/capture_names.h"
#include "server/calib/camera/intrinsics.h"

namespace rigcal::companion {
namespace {

// The poses' own numbers are taken off: six of each view.
double CornerSigma_px(const calib::CameraEstimate& estimate, const std::map<CaptureId, std::vector<int>>& corner_idx) {
  double squares = 0, numbers = 0;
  for (const auto& [capture, rms_px] : estimate.rms_by_capture_px) {
    const auto seen = corner_idx.find(capture);
    if (seen == corner_idx.end()) continue;
    const auto count = static_cast<double>(seen->second.size());
    squares += rms_px * rms_px * count;
    numbers += 2 * count - 6;
  }
  return numbers > 0 ? std::sqrt(squares / numbers) : 0.0;
}

}  // namespace

CameraSoFar FindCameraSoFar(const SessionHeader& header, const Sensor& camera,
                            const std::map<CaptureId, check::PictureSeen>& pictures, calib::CameraMemory& lenses) {
  CameraSoFar so_far;
  so_far.found = check::FindCamera(camera, CommonTargets(header, camera, camera), pictures, lenses);
  so_far.intrinsics = camera.intrinsics;
  if (!so_far.found.board || so_far.found.with_board.empty()) return so_far;
  const auto views = check::ViewsOf(pictures, so_far.found.board->id);
  for (const auto& [capture, view] : views)
    if (so_far.found.T_cam_board.contains(capture)) so_far.corner_idx[capture] = view.corner_idx;
  const auto estimate = lenses.Estimate({camera, *so_far.found.board, views});
  if (!estimate) return so_far;
  so_far.intrinsics = estimate->intrinsics;
  for (const auto& [capture, idx] : so_far.corner_idx)
    if (const std::vector<Se3> poses = estimate->PosesOf(capture); poses.size() > 1)
      so_far.other_poses[capture] = {poses.begin() + 1, poses.end()};
  so_far.corner_sigma_px = CornerSigma_px(*estimate, so_far.corner_idx);
  return so_far;
}

std::vector<CaptureId> CapturesOf(const Captured& captured) {
  std::vector<CaptureId> all;
  for (const auto& [sensor, captures] : captured.files) all.insert(all.end(), captures.begin(), captures.end());
  return check::InOrder(std::move(all));
}

}  // namespace rigcal::companion
