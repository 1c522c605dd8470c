#include <cmath>

#include "server/base/out_of_memory.h"
#include "server/calib/camera/camera_diagnoses.h"
#include "server/calib/camera/camera_fit.h"
#include "server/calib/core/capture_blocks.h"
#include "server/calib/core/diagnoses.h"
#include "server/calib/lidar_camera/lidar_camera.h"
#include "server/calib/lidar_camera/lidar_camera_diagnoses.h"
#include "server/calib/lidar_camera/systematics.h"
#include "server/model/method.h"

namespace rigcal::calib {
namespace {

using Missing = bool (*)(const LidarCameraCapture&);

// A picture of 0 x 0 and a cloud of no points could not be read: the board was not even looked for.
bool NoPicture(const LidarCameraCapture& capture) {
  return capture.view && !capture.view->found && capture.view->image_width_px == 0;
}
bool NoCloud(const LidarCameraCapture& capture) {
  return capture.cloud && !capture.cloud->found && capture.cloud->points == 0;
}
bool OtherLayoutInPicture(const LidarCameraCapture& capture) { return capture.view && ShowsOtherLayout(*capture.view); }
bool NotInPicture(const LidarCameraCapture& capture) {
  return !NoPicture(capture) && !OtherLayoutInPicture(capture) && !(capture.view && capture.view->found);
}
bool NotInCloud(const LidarCameraCapture& capture) {
  return !NoCloud(capture) && !(capture.cloud && capture.cloud->found);
}

std::vector<CaptureId> Where(const LidarCameraProblem& problem, Missing missing) {
  std::vector<CaptureId> captures;
  for (const LidarCameraCapture& capture : problem.captures)
    if (missing(capture)) captures.push_back(capture.capture);
  return captures;
}

void AddMissing(const LidarCameraProblem& problem, std::vector<Diagnosis>& diagnoses) {
  if (const auto captures = Where(problem, OtherLayoutInPicture); !captures.empty())
    diagnoses.push_back(OtherLayout(problem.camera.id, problem.board, captures));
  if (const auto captures = Where(problem, NoPicture); !captures.empty())
    diagnoses.push_back(PicturesUnreadable(problem, captures));
  if (const auto captures = Where(problem, NoCloud); !captures.empty())
    diagnoses.push_back(CloudsUnreadable(problem, captures));
  if (const auto captures = Where(problem, NotInPicture); !captures.empty())
    diagnoses.push_back(BoardNotInPictures(problem, captures));
  if (const auto captures = Where(problem, NotInCloud); !captures.empty())
    diagnoses.push_back(BoardNotInClouds(problem, captures));
}

Edge EdgeOf(const LidarCameraProblem& problem) {
  Edge edge;
  edge.frame_a = problem.camera_is_a ? problem.camera.id : problem.lidar.id;
  edge.frame_b = problem.camera_is_a ? problem.lidar.id : problem.camera.id;
  edge.method = NameOf(Method::kLidarCamera);
  edge.figures["captures_total"] = static_cast<double>(problem.captures.size());
  return edge;
}

Edge FailedEdge(const LidarCameraProblem& problem, std::vector<Diagnosis> diagnoses) {
  Edge edge = EdgeOf(problem);
  edge.state = EdgeState::kFailed;
  edge.diagnoses = std::move(diagnoses);
  AddMissing(problem, edge.diagnoses);
  PutLayoutFirst(edge.diagnoses);
  for (const LidarCameraCapture& capture : problem.captures)
    edge.captures.push_back({capture.capture, 0.0, false, "the pair was not solved"});
  return edge;
}

void AddIntrinsicsFigures(const CameraIntrinsics& intrinsics, Edge& edge) {
  edge.figures["fx_px"] = intrinsics.fx_px;
  edge.figures["fy_px"] = intrinsics.fy_px;
  edge.figures["cx_px"] = intrinsics.cx_px;
  edge.figures["cy_px"] = intrinsics.cy_px;
  const std::vector<std::string>& names = DistortionNames(intrinsics.model);
  for (std::size_t i = 0; i < names.size(); ++i) edge.figures[names[i] + "_ratio"] = intrinsics.distortion[i];
}

void AddSystematics(const LidarCameraEstimate& estimate, Edge& edge) {
  if (!estimate.KnowsSystematics()) return;
  edge.figures["range_bias_m"] = estimate.range_bias_m;
  edge.figures["range_bias_sigma_m"] = estimate.range_bias_sigma_m;
  edge.figures["board_scale_ratio"] = estimate.board_scale_ratio;
  edge.figures["board_scale_sigma_ratio"] = estimate.board_scale_sigma_ratio;
}

// Across the plane of the boards' normals, in the frame of a.
void AddAxis(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate, Edge& edge) {
  if (!estimate.held) return;
  const Eigen::Vector3d& axis_cam = estimate.held->axis_cam;
  const Eigen::Vector3d axis_a =
      problem.camera_is_a ? axis_cam : Eigen::Vector3d(estimate.T_cam_lidar.R().transpose() * axis_cam);
  edge.figures["axis_a_x_ratio"] = axis_a.x();
  edge.figures["axis_a_y_ratio"] = axis_a.y();
  edge.figures["axis_a_z_ratio"] = axis_a.z();
}

void AddFigures(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate, Edge& edge) {
  AddAxis(problem, estimate, edge);
  AddSystematics(estimate, edge);
  std::size_t points = 0;
  for (const auto& [capture, check] : estimate.checks) points += check.points;
  edge.figures["captures_used"] = static_cast<double>(estimate.patch_idx.size());
  edge.figures["points_used"] = static_cast<double>(points);
  edge.figures["plane_distance_rms_m"] = estimate.rms_m;
  edge.figures["plane_angle_rms_rad"] = estimate.rms_rad;
  edge.figures["range_sigma_m"] = estimate.range_sigma_m;
  edge.figures["capture_sigma_m"] = estimate.capture_sigma_m;
  edge.figures["rms_px"] = estimate.camera.rms_px;
  AddIntrinsicsFigures(estimate.camera.intrinsics, edge);
}

void AddNotes(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate, std::vector<Diagnosis>& notes) {
  if (estimate.patch_idx.size() < kLidarCapturesEnough)
    notes.push_back(FewLidarCaptures(problem, estimate.patch_idx.size()));
  std::vector<PlaneCapture> planes;
  for (const auto& [capture, idx] : estimate.patch_idx)
    planes.push_back({estimate.camera.T_cam_board.at(capture), {}, {}});
  if (estimate.held)
    notes.push_back(NormalsInOnePlane(problem, estimate.held->axis_cam));
  else if (const NormalSpread spread = SpreadOf(planes); spread.sigma_m > kNormalSigmaGood_m)
    notes.push_back(WeakNormalSpread(problem, spread.cone_deg, spread.sigma_m));
  if (estimate.SuspectsBoardSize())
    notes.push_back(BoardSizeSuspected(problem, estimate));
  else if (!(problem.board.square_sigma_m > 0))
    notes.push_back(BoardSizeTakenAsExact(problem));
  if (estimate.SuspectsRangeBias())
    notes.push_back(RangeBiasSuspected(problem, estimate));
  else if (!problem.lidar.range_bias_sigma_m)
    notes.push_back(RangeTakenAsExact(problem));
  if (problem.camera.intrinsics && !problem.camera.intrinsics_sigma)
    notes.push_back(IntrinsicsTakenAsExact(problem.camera.id));
  if (auto why = WhyGivenDisagree(problem.camera, estimate.camera.intrinsics)) notes.push_back(std::move(*why));
  AddMissing(problem, notes);
}

Edge Solved(const LidarCameraProblem& problem, std::vector<CameraFit>* fits) {
  std::vector<Diagnosis> notes;
  if (fits) *fits = FitsOf(problem, nullptr);
  auto estimate = EstimateLidarCamera(problem, nullptr, &notes);
  if (!estimate) return FailedEdge(problem, {estimate.error()});
  if (fits) *fits = FitsOf(problem, &estimate->camera);
  if (const Status widened = WidenSystematics(problem, *estimate); !widened)
    return FailedEdge(problem, {NotSolvable(problem, widened.error())});
  if (std::abs(estimate->board_scale_ratio) > kScaleMax_ratio && estimate->SuspectsBoardSize())
    return FailedEdge(problem, {BoardSizeSuspected(problem, *estimate)});
  if (std::abs(estimate->range_bias_m) > kBiasMax_m && estimate->SuspectsRangeBias())
    return FailedEdge(problem, {RangeBiasSuspected(problem, *estimate)});
  if (!(estimate->rms_m <= kHighRms_m && estimate->rms_rad <= kHighRms_rad)) {
    notes.insert(notes.begin(), HighLidarResidual(problem, *estimate));
    Edge edge = FailedEdge(problem, std::move(notes));
    edge.captures = estimate->residuals;
    AddFigures(problem, *estimate, edge);
    return edge;
  }
  auto uncertainty = JackknifeLidarCamera(problem, *estimate);
  if (!uncertainty) return FailedEdge(problem, {NotSolvable(problem, uncertainty.error())});
  Edge edge = EdgeOf(problem);
  edge.state = EdgeState::kGood;
  edge.T_a_b = problem.camera_is_a ? estimate->T_cam_lidar : estimate->T_cam_lidar.Inverse();
  edge.uncertainty = std::move(*uncertainty);
  edge.captures = estimate->residuals;
  edge.diagnoses = std::move(notes);
  AddNotes(problem, *estimate, edge.diagnoses);
  AddFigures(problem, *estimate, edge);
  return edge;
}

std::set<CaptureId> SeenByBoth(const LidarCameraProblem& problem) {
  std::set<CaptureId> both;
  for (const LidarCameraCapture& capture : problem.captures)
    if (capture.view && capture.view->found && capture.cloud && capture.cloud->found) both.insert(capture.capture);
  return both;
}

}  // namespace

Edge EstimateLidarCameraEdge(const LidarCameraProblem& problem, std::vector<CameraFit>* fits) {
  try {
    return EstimateOfChosen(problem, CapturesOf(problem), SeenByBoth(problem), DropCaptures<LidarCameraProblem>,
                            [&](const LidarCameraProblem& chosen) { return Solved(chosen, fits); });
  } catch (const std::exception& exception) {
    if (IsOutOfMemory(exception)) throw;  // not the data's fault: the caller tries again
    return FailedEdge(
        problem,
        {NotSolvable(problem, {ErrorCode::kInternal, exception.what(), "Report this with the session's id."})});
  }
}

}  // namespace rigcal::calib
