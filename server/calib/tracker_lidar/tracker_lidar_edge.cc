#include <cmath>

#include "server/base/out_of_memory.h"
#include "server/calib/core/capture_blocks.h"
#include "server/calib/lidar_camera/lidar_camera_diagnoses.h"
#include "server/calib/tracker_lidar/tracker_lidar.h"
#include "server/calib/tracker_lidar/tracker_lidar_diagnoses.h"
#include "server/calib/tracker_lidar/tracker_lidar_work.h"
#include "server/model/method.h"

namespace rigcal::calib {
namespace {

Edge EdgeOf(const TrackerLidarProblem& problem) {
  Edge edge;
  edge.frame_a = problem.tracker_is_a ? problem.tracker.id : problem.lidar.id;
  edge.frame_b = problem.tracker_is_a ? problem.lidar.id : problem.tracker.id;
  edge.method = NameOf(Method::kTrackerLidar);
  edge.figures["captures_total"] = static_cast<double>(problem.captures.size());
  return edge;
}

void AddDiagnoses(std::vector<Diagnosis> more, Edge& edge) {
  for (Diagnosis& diagnosis : more) edge.diagnoses.push_back(std::move(diagnosis));
}

Edge FailedEdge(const TrackerLidarProblem& problem, const Diagnosis& diagnosis) {
  Edge edge = EdgeOf(problem);
  edge.state = EdgeState::kFailed;
  edge.diagnoses = {diagnosis};
  AddDiagnoses(MissedClouds(problem), edge);
  for (const TrackerLidarCapture& capture : problem.captures)
    edge.captures.push_back({capture.capture, 0.0, false, "the pair was not solved"});
  return edge;
}

void AddReach(const TrackerLidarEstimate& estimate, Edge& edge) {
  edge.figures["tilt_rad"] = estimate.motion.tilt_rad;
  edge.figures["tilt_noise_rad"] = estimate.motion.tilt_noise_rad;
  edge.figures["turn_rad"] = estimate.motion.turn_rad;
  edge.figures["weakest_over_noise_ratio"] = estimate.reach.weakest_noises;
}

void AddFigures(const TrackerLidarEstimate& estimate, Edge& edge) {
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
  AddReach(estimate, edge);
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
    AddFigures(estimate, edge);
    return edge;
  }
  Edge edge = EdgeOf(problem);
  edge.state = EdgeState::kGood;
  edge.T_a_b = problem.tracker_is_a ? estimate.T_body_lidar : estimate.T_body_lidar.Inverse();
  edge.uncertainty = std::move(result->uncertainty);
  edge.diagnoses = std::move(result->notes);
  if (estimate.checks.size() < kTrackerLidarEnough)
    edge.diagnoses.push_back(FewPlaced(problem, estimate.checks.size()));
  if (!problem.lidar.range_bias_sigma_m) edge.diagnoses.push_back(RangesTakenAsExact(problem));
  AddDiagnoses(MissedClouds(problem), edge);
  AddCaptures(problem, estimate, edge);
  AddFigures(estimate, edge);
  return edge;
}

std::set<CaptureId> SeenByBoth(const TrackerLidarProblem& problem) {
  std::set<CaptureId> both;
  for (const TrackerLidarCapture& capture : problem.captures)
    if (capture.T_world_body && !PatchesOf(capture).empty()) both.insert(capture.capture);
  return both;
}

}  // namespace

Edge EstimateTrackerLidarEdge(const TrackerLidarProblem& problem) {
  try {
    return EstimateOfChosen(problem, CapturesOf(problem), SeenByBoth(problem), DropCaptures<TrackerLidarProblem>, Solved);
  } catch (const std::exception& exception) {
    if (IsOutOfMemory(exception)) throw;  // not the data's fault: the caller tries again
    return FailedEdge(problem, TrackerLidarNotSolvable(problem, {ErrorCode::kInternal, exception.what(),
                                                                 "Report this with the session's id."}));
  }
}

}  // namespace rigcal::calib
