#include <cmath>
#include <set>

#include "server/base/out_of_memory.h"
#include "server/calib/camera/camera_diagnoses.h"
#include "server/calib/camera/camera_fit.h"
#include "server/calib/core/capture_blocks.h"
#include "server/calib/motion/hand_eye.h"
#include "server/calib/motion/hand_eye_diagnoses.h"
#include "server/calib/motion/hand_eye_work.h"

namespace rigcal::calib {
namespace {

// Residuals beyond these mean that something is wrong, not noisy.
constexpr double kHighRms_m = 0.1, kHighRms_rad = 0.05;

std::set<CaptureId> AllCaptures(const HandEyeProblem& problem) {
  std::set<CaptureId> captures;
  for (const HandEyeSide* side : {&problem.a, &problem.b}) {
    for (const auto& [capture, view] : side->views) captures.insert(capture);
    for (const TimedPose& pose : side->poses)
      if (!pose.capture.empty()) captures.insert(pose.capture);
  }
  return captures;
}

Edge EdgeOf(const HandEyeProblem& problem) {
  Edge edge;
  edge.frame_a = problem.a.sensor.id;
  edge.frame_b = problem.b.sensor.id;
  edge.method = NameOf(problem.method);
  if (problem.method != Method::kPoseStreams)
    edge.figures["captures_total"] = static_cast<double>(AllCaptures(problem).size());
  return edge;
}

Edge FailedEdge(const HandEyeProblem& problem, const Diagnosis& diagnosis) {
  Edge edge = EdgeOf(problem);
  edge.state = EdgeState::kFailed;
  edge.diagnoses = {diagnosis};
  for (Diagnosis& missed : MissedViews(problem)) edge.diagnoses.push_back(std::move(missed));
  PutLayoutFirst(edge.diagnoses);
  for (const CaptureId& capture : AllCaptures(problem))
    edge.captures.push_back({capture, 0.0, false, "the pair was not solved"});
  return edge;
}

void AddNoise(const std::string& side, const SideNoise& noise, Edge& edge) {
  edge.figures["noise_" + side + "_m"] = noise.translation_m;
  edge.figures["noise_" + side + "_rad"] = noise.rotation_rad;
}

void AddReach(const MotionReach& reach, Edge& edge) {
  edge.figures["tilt_rad"] = reach.tilt_rad;
  edge.figures["tilt_noise_rad"] = reach.tilt_noise_rad;
  edge.figures["turn_rad"] = reach.turn_rad;
  if (reach.open.cols() == 0) return;
  edge.figures["axis_a_x_ratio"] = reach.axis_a.x();
  edge.figures["axis_a_y_ratio"] = reach.axis_a.y();
  edge.figures["axis_a_z_ratio"] = reach.axis_a.z();
}

void AddFigures(const HandEyeEstimate& estimate, Edge& edge) {
  edge.figures[estimate.offset_s ? "samples_used" : "captures_used"] = static_cast<double>(estimate.captures);
  edge.figures["motion_rms_m"] = estimate.rms_m;
  edge.figures["motion_rms_rad"] = estimate.rms_rad;
  AddNoise("a", estimate.noise_a, edge);
  AddNoise("b", estimate.noise_b, edge);
  AddReach(estimate.reach, edge);
  if (estimate.offset_s) edge.figures["clock_offset_s"] = *estimate.offset_s;
  if (estimate.offset_sigma_s) edge.figures["clock_offset_sigma_s"] = *estimate.offset_sigma_s;
}

void AddCaptures(const HandEyeProblem& problem, const HandEyeEstimate& estimate, Edge& edge) {
  for (const CaptureId& capture : AllCaptures(problem)) {
    const auto residual = estimate.residuals.find(capture);
    const auto why = estimate.unused.find(capture);
    if (residual != estimate.residuals.end())
      edge.captures.push_back({capture, residual->second.head<3>().norm(), true, {}});
    else
      edge.captures.push_back({capture, 0.0, false, why == estimate.unused.end() ? "no pose" : why->second});
  }
}

const CameraEstimate* PointerTo(const std::optional<CameraEstimate>& camera) { return camera ? &*camera : nullptr; }

Edge Solved(const HandEyeProblem& problem, std::vector<CameraFit>* fits) {
  if (fits) *fits = FitsOf(problem, nullptr, nullptr);
  auto result = EstimateHandEye(problem);
  if (!result) return FailedEdge(problem, result.error());
  if (fits) *fits = FitsOf(problem, PointerTo(result->camera_a), PointerTo(result->camera_b));
  const HandEyeEstimate& estimate = result->estimate;
  if (!(estimate.rms_m <= kHighRms_m && estimate.rms_rad <= kHighRms_rad)) {
    Edge edge = FailedEdge(problem, HighMotionResidual(problem, estimate));
    AddFigures(estimate, edge);
    return edge;
  }
  Edge edge = EdgeOf(problem);
  edge.state = EdgeState::kGood;
  edge.T_a_b = estimate.T_a_b;
  edge.uncertainty = std::move(result->uncertainty);
  edge.diagnoses = std::move(result->notes);
  if (!estimate.offset_s && estimate.captures < kHandEyeEnough)
    edge.diagnoses.push_back(FewMotions(problem, estimate.captures));
  for (Diagnosis& note : TakenAsExact(problem)) edge.diagnoses.push_back(std::move(note));
  for (Diagnosis& missed : MissedViews(problem)) edge.diagnoses.push_back(std::move(missed));
  AddCaptures(problem, estimate, edge);
  AddFigures(estimate, edge);
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

void Drop(HandEyeProblem& problem, const std::set<CaptureId>& left_out) {
  for (HandEyeSide* side : {&problem.a, &problem.b}) {
    std::erase_if(side->views, [&](const auto& view) { return left_out.contains(view.first); });
    std::erase_if(side->poses, [&](const TimedPose& pose) { return left_out.contains(pose.capture); });
  }
}

}  // namespace

Edge EstimateHandEyeEdge(const HandEyeProblem& problem, std::vector<CameraFit>* fits) {
  try {
    if (problem.method == Method::kPoseStreams) return Solved(problem, fits);
    return EstimateOfChosen(problem, AllCaptures(problem), SeenByBoth(problem), Drop,
                            [&](const HandEyeProblem& chosen) { return Solved(chosen, fits); });
  } catch (const std::exception& exception) {
    if (IsOutOfMemory(exception)) throw;  // not the data's fault: the caller tries again
    return FailedEdge(problem, MotionNotSolvable(problem, {ErrorCode::kInternal, exception.what(),
                                                           "Report this with the session's id."}));
  }
}

}  // namespace rigcal::calib
