#include <set>

#include "server/calib/camera/camera_fit.h"
#include "server/calib/core/pair_edge.h"
#include "server/calib/motion/hand_eye.h"
#include "server/calib/motion/hand_eye_work.h"
#include "server/calib/motion/motion_edge.h"

namespace rigcal::calib {
namespace {

// Residuals beyond these mean that something is wrong, not noisy.
constexpr double kHighRms_m = 0.1, kHighRms_rad = 0.05;

void AddMetrics(const HandEyeProblem& problem, const HandEyeEstimate& estimate, Edge& edge) {
  edge.figures[estimate.offset_s ? "samples_used" : "captures_used"] = static_cast<double>(estimate.captures);
  AddMotionMetrics(
      problem,
      {estimate.rms_m, estimate.rms_rad, estimate.noise_a, estimate.noise_b, estimate.reach, estimate.board_scale},
      edge);
  if (estimate.offset_s) edge.figures["clock_offset_s"] = *estimate.offset_s;
  if (estimate.offset_sigma_s) edge.figures["clock_offset_sigma_s"] = *estimate.offset_sigma_s;
}

void AddCaptures(const HandEyeProblem& problem, const HandEyeEstimate& estimate, Edge& edge) {
  const auto residual_m = [&](const CaptureId& capture) -> std::optional<double> {
    const auto found = estimate.residuals.find(capture);
    return found == estimate.residuals.end() ? std::nullopt : std::optional(found->second.head<3>().norm());
  };
  AddCapturesOfSides(problem, residual_m, estimate.unused, edge);
}

// Of the sides that are cameras. Without a result: what was seen.
std::vector<CameraFit> FitsOf(const HandEyeProblem& problem, const HandEyeResult* result) {
  std::vector<CameraFit> fits;
  const auto add = [&](const HandEyeSide& side, std::optional<CameraEstimate> HandEyeResult::*camera) {
    if (side.sensor.kind != SensorKind::kCamera || !side.board) return;
    const bool solved = result != nullptr && result->*camera;
    fits.push_back(FitOrSeen({side.sensor, *side.board, side.views}, solved ? &*(result->*camera) : nullptr));
  };
  add(problem.a, &HandEyeResult::camera_a);
  add(problem.b, &HandEyeResult::camera_b);
  return fits;
}

// Solved, and not believed.
std::optional<Diagnosis> WhyRefused(const HandEyeProblem& problem, const HandEyeEstimate& estimate) {
  if (estimate.board_scale && estimate.board_scale->Contradicts(*SideWithBoard(problem).board))
    return MotionOfOtherSize(problem, *estimate.board_scale);
  if (!(estimate.rms_m <= kHighRms_m && estimate.rms_rad <= kHighRms_rad)) return HighMotionResidual(problem, estimate);
  return std::nullopt;
}

Edge Solved(const HandEyeProblem& problem, std::vector<CameraFit>* fits) {
  if (fits) *fits = FitsOf(problem, nullptr);
  auto result = EstimateHandEye(problem);
  if (!result) return FailedMotionEdge(problem, {result.error()});
  if (fits) *fits = FitsOf(problem, &*result);
  const HandEyeEstimate& estimate = result->estimate;
  if (const auto refused = WhyRefused(problem, estimate)) {
    Edge edge = FailedMotionEdge(problem, {*refused});
    AddMetrics(problem, estimate, edge);
    return edge;
  }
  Edge edge =
      Good(estimate.T_a_b, std::move(result->uncertainty), std::move(result->notes), UnsolvedMotionEdge(problem));
  if (!estimate.offset_s && estimate.captures < kHandEyeEnough)
    edge.diagnoses.push_back(FewMotions(problem, estimate.captures));
  Append(TakenAsExact(problem), edge.diagnoses);
  Append(MissedViews(problem), edge.diagnoses);
  AddCaptures(problem, estimate, edge);
  AddMetrics(problem, estimate, edge);
  AddFilesOfSides(problem, edge);
  return edge;
}

std::set<CaptureId> SeenBy(const HandEyeSide& side) {
  std::set<CaptureId> captures;
  for (const auto& [capture, view] : side.views)
    if (view.found) captures.insert(capture);
  for (const TimedPose& pose : side.poses)
    if (!pose.capture.empty()) captures.insert(pose.capture);
  return captures;
}

std::set<CaptureId> SeenByBoth(const HandEyeProblem& problem) {
  const std::set<CaptureId> by_b = SeenBy(problem.b);
  std::set<CaptureId> both = SeenBy(problem.a);
  std::erase_if(both, [&](const CaptureId& capture) { return !by_b.contains(capture); });
  return both;
}

}  // namespace

Edge EstimateHandEyeEdge(const HandEyeProblem& problem, std::vector<CameraFit>* fits) {
  const auto estimate = [&](const HandEyeProblem& chosen) { return Solved(chosen, fits); };
  const auto failed = [&](const Error& error) {
    return FailedMotionEdge(problem, {MotionNotSolvable(problem, error)});
  };
  if (problem.method == Method::kPoseStreams) return Guarded([&] { return estimate(problem); }, failed);
  return EdgeOfChosen(problem, CapturesOfSides(problem), SeenByBoth(problem), DropFromSides, estimate, failed);
}

}  // namespace rigcal::calib
