#include "server/calib/tracker_lidar/tracker_lidar.h"

#include <algorithm>
#include <cmath>

#include "server/calib/core/pair_edge.h"
#include "server/calib/lidar_camera/lidar_camera_diagnoses.h"
#include "server/calib/tracker_lidar/tracker_lidar_work.h"

namespace rigcal::calib {
namespace {

// The first covariance stands for all: a tracker is as good in every capture.
void SetNoise(const TrackerLidarWork& work, TrackerLidarEstimate& estimate) {
  const Matrix6d& covariance = work.problem.captures.front().covariance;
  estimate.noise_m = std::sqrt(covariance(0, 0));
  estimate.noise_rad = std::sqrt(covariance(3, 3));
}

TrackerLidarEstimate EstimateOf(const TrackerLidarProblem& problem, const TrackerLidarWork& work) {
  TrackerLidarEstimate estimate;
  estimate.T_body_lidar = work.state.T_body_lidar;
  estimate.boards = work.state.planes;
  // Back from the middle of the body's places to the tracker's own origin.
  const Eigen::Vector3d origin_m =
      problem.captures[work.captures.front()].T_world_body->p_m - work.problem.captures.front().T_world_body.p_m;
  for (WorldPlane& board : estimate.boards) board.distance_m += board.normal.dot(origin_m);
  estimate.reach = work.reach;
  estimate.motion = work.motion;
  estimate.information = ModelInformation(work);
  estimate.range_sigma_m = work.range_sigma_m;
  SetNoise(work, estimate);
  for (const auto& [idx, why] : work.unused) estimate.unused[problem.captures[idx].capture] = why;
  for (std::size_t k = 0; k < work.captures.size(); ++k) {
    const TrackerLidarCheck check = CheckOf(work, k);
    estimate.checks[problem.captures[work.captures[k]].capture] = check;
    estimate.rms_m += check.distance_m * check.distance_m / static_cast<double>(work.captures.size());
    estimate.rms_rad += check.angle_rad * check.angle_rad / static_cast<double>(work.captures.size());
  }
  estimate.rms_m = std::sqrt(estimate.rms_m);
  estimate.rms_rad = std::sqrt(estimate.rms_rad);
  return estimate;
}

Edge EdgeOf(const TrackerLidarProblem& problem) {
  const SensorId &tracker = problem.tracker.id, &lidar = problem.lidar.id;
  return UnsolvedEdge(problem.tracker_is_a ? tracker : lidar, problem.tracker_is_a ? lidar : tracker,
                      Method::kTrackerLidar, problem.captures.size());
}

void AddFiles(const TrackerLidarProblem& problem, Edge& edge) {
  FilesFound poses, clouds;
  for (std::size_t idx = 0; idx < problem.captures.size(); ++idx) {
    const TrackerLidarCapture& capture = problem.captures[idx];
    if (capture.T_world_body) poses.Add(idx, true, true);
    if (!capture.clouds.empty()) clouds.Add(idx, capture.clouds.front().points > 0, !PatchesOf(capture).empty());
  }
  AddFilesFound(poses, problem.tracker_is_a ? "_a" : "_b", edge);
  AddFilesFound(clouds, problem.tracker_is_a ? "_b" : "_a", edge);
}

PoseTable PosesOf(const TrackerLidarProblem& problem) {
  PoseTable poses;
  for (const TrackerLidarCapture& capture : problem.captures)
    if (capture.T_world_body) poses.push_back({capture.capture, {}, *capture.T_world_body});
  return poses;
}

Edge FailedEdge(const TrackerLidarProblem& problem, const Diagnosis& diagnosis) {
  Edge edge = EdgeOf(problem);
  for (const TrackerLidarCapture& capture : problem.captures)
    edge.captures.push_back({capture.capture, 0.0, false, "the pair was not solved"});
  AddFiles(problem, edge);
  std::vector<Diagnosis> diagnoses = {diagnosis};
  if (auto unit = PositionsInMillimetres(problem.tracker.id, PosesOf(problem), problem.tracker_is_a ? "_a" : "_b"))
    diagnoses.insert(diagnoses.begin(), std::move(*unit));
  Append(MissedClouds(problem), diagnoses);
  return FailedFor(std::move(diagnoses), std::move(edge));
}

void AddMetrics(const TrackerLidarEstimate& estimate, Edge& edge) {
  std::size_t points = 0, patches = 0;
  for (const auto& [capture, check] : estimate.checks) points += check.points, patches += check.boards;
  edge.figures["captures_used"] = static_cast<double>(estimate.checks.size());
  edge.figures["planes_used"] = static_cast<double>(estimate.boards.size());
  edge.figures["patches_used"] = static_cast<double>(patches);
  edge.figures["points_used"] = static_cast<double>(points);
  edge.figures["plane_distance_rms_m"] = estimate.rms_m;
  edge.figures["plane_angle_rms_rad"] = estimate.rms_rad;
  edge.figures["range_sigma_m"] = estimate.range_sigma_m;
  edge.figures["tracker_sigma_m"] = estimate.noise_m;
  edge.figures["tracker_sigma_rad"] = estimate.noise_rad;
  AddMotionFigures(estimate.motion, edge);
  edge.figures["weakest_over_noise_ratio"] = estimate.reach.weakest_noises;
}

void AddCaptures(const TrackerLidarProblem& problem, const TrackerLidarEstimate& estimate, Edge& edge) {
  for (const TrackerLidarCapture& capture : problem.captures) {
    const auto check = estimate.checks.find(capture.capture);
    const auto why = estimate.unused.find(capture.capture);
    if (check != estimate.checks.end())
      edge.captures.push_back({capture.capture, check->second.distance_m, true, {}});
    else
      edge.captures.push_back({capture.capture, 0.0, false, why == estimate.unused.end() ? "not used" : why->second});
  }
}

Edge Solved(const TrackerLidarProblem& problem) {
  auto result = EstimateTrackerLidar(problem);
  if (!result) return FailedEdge(problem, result.error());
  const TrackerLidarEstimate& estimate = result->estimate;
  if (!(estimate.rms_m <= kHighRms_m && estimate.rms_rad <= kHighRms_rad)) {
    Edge edge = FailedEdge(problem, HighPlaneResidual(problem, estimate));
    AddMetrics(estimate, edge);
    return edge;
  }
  Edge edge = Good(EdgePose(problem, estimate.T_body_lidar), std::move(result->uncertainty), std::move(result->notes),
                   EdgeOf(problem));
  if (estimate.checks.size() < kTrackerLidarEnough)
    edge.diagnoses.push_back(FewPlaced(problem, estimate.checks.size()));
  if (!problem.lidar.range_bias_sigma_m) edge.diagnoses.push_back(RangeTakenAsExact(problem.lidar.id));
  Append(MissedClouds(problem), edge.diagnoses);
  AddCaptures(problem, estimate, edge);
  AddMetrics(estimate, edge);
  AddFiles(problem, edge);
  return edge;
}

std::set<CaptureId> SeenByBoth(const TrackerLidarProblem& problem) {
  return CapturesOf(
      problem, [](const TrackerLidarCapture& capture) { return capture.T_world_body && !PatchesOf(capture).empty(); });
}

}  // namespace

OrDiagnosis<TrackerLidarResult> EstimateTrackerLidar(const TrackerLidarProblem& problem) {
  RIGCAL_ASSIGN(auto work, CollectPatches(problem));
  if (auto fitted = FitPatches(problem, work); !fitted) return tl::unexpected(fitted.error());
  auto uncertainty = JackknifeTrackerLidar(problem, work);
  if (!uncertainty) return tl::unexpected(TrackerLidarNotSolvable(problem, uncertainty.error()));
  TrackerLidarResult result{EstimateOf(problem, work), std::move(*uncertainty), {}};
  result.notes = OpenDirections(problem, result.estimate);
  std::vector<CaptureId> contradicting;
  for (const std::size_t idx : work.contradicting) contradicting.push_back(problem.captures[idx].capture);
  std::sort(contradicting.begin(), contradicting.end());
  if (!contradicting.empty()) result.notes.push_back(PlacedContradict(problem, contradicting));
  return result;
}

Edge EstimateTrackerLidarEdge(const TrackerLidarProblem& problem) {
  const auto failed = [&](const Error& error) { return FailedEdge(problem, TrackerLidarNotSolvable(problem, error)); };
  return EdgeOfChosen(problem, CapturesOf(problem), SeenByBoth(problem), DropCaptures<TrackerLidarProblem>, Solved,
                      failed);
}

}  // namespace rigcal::calib
