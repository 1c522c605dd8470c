#include "server/calib/tracker_lidar/tracker_lidar.h"

#include <algorithm>
#include <cmath>

#include "server/calib/tracker_lidar/tracker_lidar_diagnoses.h"
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

}  // namespace

tl::expected<TrackerLidarResult, Diagnosis> EstimateTrackerLidar(const TrackerLidarProblem& problem) {
  auto work = CollectPatches(problem);
  if (!work) return tl::unexpected(work.error());
  if (auto fitted = FitPatches(problem, *work); !fitted) return tl::unexpected(fitted.error());
  auto uncertainty = JackknifeTrackerLidar(problem, *work);
  if (!uncertainty) return tl::unexpected(TrackerLidarNotSolvable(problem, uncertainty.error()));
  TrackerLidarResult result{EstimateOf(problem, *work), std::move(*uncertainty), {}};
  result.notes = OpenDirections(problem, result.estimate);
  std::vector<CaptureId> contradicting;
  for (const std::size_t idx : work->contradicting) contradicting.push_back(problem.captures[idx].capture);
  std::sort(contradicting.begin(), contradicting.end());
  if (!contradicting.empty()) result.notes.push_back(PlacedContradict(problem, contradicting));
  return result;
}

}  // namespace rigcal::calib
