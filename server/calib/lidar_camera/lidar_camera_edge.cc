#include <cmath>

#include "server/calib/camera/camera_diagnoses.h"
#include "server/calib/camera/camera_fit.h"
#include "server/calib/core/pair_edge.h"
#include "server/calib/core/selection.h"
#include "server/calib/lidar_camera/lidar_camera.h"
#include "server/calib/lidar_camera/lidar_camera_diagnoses.h"
#include "server/calib/lidar_camera/lidar_camera_work.h"

namespace rigcal::calib {
namespace {

// A picture of 0 x 0 and a cloud of no points could not be read: the board was not even looked for.
bool NoPicture(const LidarCameraCapture& capture) {
  return capture.view && !capture.view->found && capture.view->image_width_px == 0;
}
bool NoCloud(const LidarCameraCapture& capture) {
  return capture.cloud && !capture.cloud->found && capture.cloud->points == 0;
}

void AddMissing(const LidarCameraProblem& problem, std::vector<Diagnosis>& diagnoses) {
  MissedCaptures other_layout, no_picture, no_cloud, not_in_picture, not_in_cloud;
  for (const LidarCameraCapture& capture : problem.captures) {
    const CaptureId& id = capture.capture;
    const std::string why = capture.view ? capture.view->why_not : "there is no picture";
    const std::string why_no_cloud = capture.cloud ? capture.cloud->why_not : "there is no cloud";
    const bool misdescribed = capture.view && ShowsOtherLayout(*capture.view);
    if (misdescribed) other_layout.Add(id, why);
    if (NoPicture(capture)) no_picture.Add(id, why);
    if (NoCloud(capture)) no_cloud.Add(id, why_no_cloud);
    if (!NoPicture(capture) && !misdescribed && !(capture.view && capture.view->found)) not_in_picture.Add(id, why);
    if (!NoCloud(capture) && !(capture.cloud && capture.cloud->found)) not_in_cloud.Add(id, why_no_cloud);
  }
  const SensorId &camera = problem.camera.id, &lidar = problem.lidar.id;
  if (!other_layout.captures.empty()) diagnoses.push_back(OtherLayout(camera, problem.board, other_layout.captures));
  if (!no_picture.captures.empty()) diagnoses.push_back(Unreadable(camera, no_picture));
  if (!no_cloud.captures.empty()) diagnoses.push_back(CloudsUnreadable(lidar, no_cloud));
  if (!not_in_picture.captures.empty()) diagnoses.push_back(BoardNotFound(camera, BoardOf(problem), not_in_picture));
  if (!not_in_cloud.captures.empty()) diagnoses.push_back(BoardNotInClouds(problem, not_in_cloud));
}

Edge EdgeOf(const LidarCameraProblem& problem) {
  const SensorId &camera = problem.camera.id, &lidar = problem.lidar.id;
  return UnsolvedEdge(problem.camera_is_a ? camera : lidar, problem.camera_is_a ? lidar : camera, Method::kLidarCamera,
                      problem.captures.size());
}

void AddFiles(const LidarCameraProblem& problem, Edge& edge) {
  FilesFound pictures, clouds;
  for (std::size_t idx = 0; idx < problem.captures.size(); ++idx) {
    const LidarCameraCapture& capture = problem.captures[idx];
    if (capture.view) pictures.Add(idx, !NoPicture(capture), Sees(capture.view, problem.board));
    if (capture.cloud) clouds.Add(idx, !NoCloud(capture), capture.cloud->found);
  }
  AddFilesFound(pictures, SideOfCamera(problem), edge);
  AddFilesFound(clouds, problem.camera_is_a ? "_b" : "_a", edge);
}

Edge FailedEdge(const LidarCameraProblem& problem, std::vector<Diagnosis> diagnoses) {
  Edge edge = EdgeOf(problem);
  for (const LidarCameraCapture& capture : problem.captures)
    edge.captures.push_back({capture.capture, 0.0, false, "the pair was not solved"});
  AddFiles(problem, edge);
  AddMissing(problem, diagnoses);
  return FailedFor(std::move(diagnoses), std::move(edge));
}

// Of the camera. Without an estimate: what was seen.
std::vector<CameraFit> FitsOf(const LidarCameraProblem& problem, const CameraEstimate* camera) {
  return {FitOrSeen(CameraOf(problem), camera)};
}

void AddSystematics(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate, Edge& edge) {
  if (!estimate.KnowsSystematics()) return;
  edge.figures["range_bias_m"] = estimate.range_bias_m;
  edge.figures["range_bias_sigma_m"] = estimate.range_bias_sigma_m;
  edge.figures["board_scale_ratio"] = estimate.board_scale_ratio;
  edge.figures["board_scale_sigma_ratio"] = estimate.board_scale_sigma_ratio;
  edge.figures["board_square_m"] = problem.board.square_m;
}

// Across the plane of the boards' normals, in the frame of a.
void AddAxis(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate, Edge& edge) {
  if (!estimate.held) return;
  const Eigen::Vector3d& axis_cam = estimate.held->axis_cam;
  AddAxisFigures(problem.camera_is_a ? axis_cam : Eigen::Vector3d(estimate.T_cam_lidar.R().transpose() * axis_cam),
                 edge);
}

void AddMetrics(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate, Edge& edge) {
  AddAxis(problem, estimate, edge);
  AddSystematics(problem, estimate, edge);
  std::size_t points = 0;
  for (const auto& [capture, check] : estimate.checks) points += check.points;
  edge.figures["captures_used"] = static_cast<double>(estimate.patch_idx.size());
  edge.figures["points_used"] = static_cast<double>(points);
  edge.figures["plane_distance_rms_m"] = estimate.rms_m;
  edge.figures["plane_angle_rms_rad"] = estimate.rms_rad;
  edge.figures["range_sigma_m"] = estimate.range_sigma_m;
  edge.figures["capture_sigma_m"] = estimate.capture_sigma_m;
  edge.figures["rms_px"] = estimate.camera.rms_px;
  AddIntrinsicsFigures(estimate.camera.intrinsics, "", edge);
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
    notes.push_back(RangeTakenAsExact(problem.lidar.id));
  if (problem.camera.intrinsics && !problem.camera.intrinsics_sigma)
    notes.push_back(IntrinsicsTakenAsExact(problem.camera.id));
  if (auto why = WhyGivenDisagree(problem.camera, estimate.camera.intrinsics)) notes.push_back(std::move(*why));
  AddMissing(problem, notes);
}

// Solved, and not believed.
Edge Refused(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate, std::vector<Diagnosis> diagnoses) {
  Edge edge = FailedEdge(problem, std::move(diagnoses));
  edge.captures = estimate.residuals;
  AddMetrics(problem, estimate, edge);
  return edge;
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
    return Refused(problem, *estimate, {BoardSizeSuspected(problem, *estimate)});
  if (std::abs(estimate->range_bias_m) > kBiasMax_m && estimate->SuspectsRangeBias())
    return Refused(problem, *estimate, {RangeBiasSuspected(problem, *estimate)});
  if (!(estimate->rms_m <= kHighRms_m && estimate->rms_rad <= kHighRms_rad)) {
    notes.insert(notes.begin(), HighLidarResidual(problem, *estimate));
    return Refused(problem, *estimate, std::move(notes));
  }
  auto uncertainty = JackknifeLidarCamera(problem, *estimate);
  if (!uncertainty) return FailedEdge(problem, {NotSolvable(problem, uncertainty.error())});
  Edge edge = Good(problem.camera_is_a ? estimate->T_cam_lidar : estimate->T_cam_lidar.Inverse(),
                   std::move(*uncertainty), std::move(notes), EdgeOf(problem));
  edge.captures = estimate->residuals;
  AddNotes(problem, *estimate, edge.diagnoses);
  AddMetrics(problem, *estimate, edge);
  AddFiles(problem, edge);
  return edge;
}

std::set<CaptureId> SeenByBoth(const LidarCameraProblem& problem) {
  return CapturesOf(problem, [](const LidarCameraCapture& capture) {
    return capture.view && capture.view->found && capture.cloud && capture.cloud->found;
  });
}

}  // namespace

Edge EstimateLidarCameraEdge(const LidarCameraProblem& problem, std::vector<CameraFit>* fits) {
  const auto estimate = [&](const LidarCameraProblem& chosen) { return Solved(chosen, fits); };
  const auto failed = [&](const Error& error) { return FailedEdge(problem, {NotSolvable(problem, error)}); };
  return EdgeOfChosen(problem, CapturesOf(problem), SeenByBoth(problem), DropCaptures<LidarCameraProblem>, estimate,
                      failed);
}

}  // namespace rigcal::calib
