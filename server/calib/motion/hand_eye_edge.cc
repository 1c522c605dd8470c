#include <iterator>
#include <set>

#include "server/calib/camera/camera_fit.h"
#include "server/calib/core/pair_edge.h"
#include "server/calib/core/selection.h"
#include "server/calib/motion/hand_eye.h"
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
  Edge edge = UnsolvedEdge(problem.a.sensor.id, problem.b.sensor.id, problem.method, AllCaptures(problem).size());
  if (problem.method == Method::kPoseStreams) edge.figures.clear();
  return edge;
}

FilesFound FilesOf(const HandEyeSide& side, const std::set<CaptureId>& captures) {
  FilesFound found;
  const auto place = [&](const CaptureId& capture) {
    return static_cast<std::size_t>(std::distance(captures.begin(), captures.find(capture)));
  };
  for (const auto& [capture, view] : side.views)
    found.Add(place(capture), view.found || view.image_width_px > 0, side.board && Sees(view, *side.board));
  for (const TimedPose& pose : side.poses)
    if (!pose.capture.empty()) found.Add(place(pose.capture), true, true);
  return found;
}

void AddFiles(const HandEyeProblem& problem, const std::set<CaptureId>& captures, Edge& edge) {
  if (problem.method == Method::kPoseStreams) return;
  AddFilesFound(FilesOf(problem.a, captures), "_a", edge);
  AddFilesFound(FilesOf(problem.b, captures), "_b", edge);
}

Edge FailedEdge(const HandEyeProblem& problem, const Diagnosis& diagnosis) {
  Edge edge = EdgeOf(problem);
  const std::set<CaptureId> captures = AllCaptures(problem);
  for (const CaptureId& capture : captures) edge.captures.push_back({capture, 0.0, false, "the pair was not solved"});
  AddFiles(problem, captures, edge);
  std::vector<Diagnosis> diagnoses;
  for (const auto& [side, name] : {std::pair{&problem.a, "_a"}, {&problem.b, "_b"}})
    if (auto unit = PositionsInMillimetres(side->sensor.id, side->poses, name)) diagnoses.push_back(std::move(*unit));
  diagnoses.push_back(diagnosis);
  Append(MissedViews(problem), diagnoses);
  return FailedFor(std::move(diagnoses), std::move(edge));
}

void AddNoise(const std::string& side, const SideNoise& noise, Edge& edge) {
  edge.figures["noise_" + side + "_m"] = noise.translation_m;
  edge.figures["noise_" + side + "_rad"] = noise.rotation_rad;
}

void AddBoardScale(const HandEyeProblem& problem, const BoardScale& scale, Edge& edge) {
  edge.figures["board_scale_ratio"] = scale.ratio;
  edge.figures["board_scale_sigma_ratio"] = scale.sigma_ratio;
  edge.figures["board_square_m"] = SideWithBoard(problem).board->square_m;
}

void AddMetrics(const HandEyeProblem& problem, const HandEyeEstimate& estimate, Edge& edge) {
  edge.figures[estimate.offset_s ? "samples_used" : "captures_used"] = static_cast<double>(estimate.captures);
  edge.figures["motion_rms_m"] = estimate.rms_m;
  edge.figures["motion_rms_rad"] = estimate.rms_rad;
  AddNoise("a", estimate.noise_a, edge);
  AddNoise("b", estimate.noise_b, edge);
  AddMotionFigures(estimate.reach, edge);
  if (estimate.reach.open.cols() > 0) AddAxisFigures(estimate.reach.axis_a, edge);
  if (estimate.board_scale) AddBoardScale(problem, *estimate.board_scale, edge);
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
  if (!result) return FailedEdge(problem, result.error());
  if (fits) *fits = FitsOf(problem, &*result);
  const HandEyeEstimate& estimate = result->estimate;
  if (const auto refused = WhyRefused(problem, estimate)) {
    Edge edge = FailedEdge(problem, *refused);
    AddMetrics(problem, estimate, edge);
    return edge;
  }
  Edge edge = Good(estimate.T_a_b, std::move(result->uncertainty), std::move(result->notes), EdgeOf(problem));
  if (!estimate.offset_s && estimate.captures < kHandEyeEnough)
    edge.diagnoses.push_back(FewMotions(problem, estimate.captures));
  Append(TakenAsExact(problem), edge.diagnoses);
  Append(MissedViews(problem), edge.diagnoses);
  AddCaptures(problem, estimate, edge);
  AddMetrics(problem, estimate, edge);
  AddFiles(problem, AllCaptures(problem), edge);
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
  const auto estimate = [&](const HandEyeProblem& chosen) { return Solved(chosen, fits); };
  const auto failed = [&](const Error& error) { return FailedEdge(problem, MotionNotSolvable(problem, error)); };
  if (problem.method == Method::kPoseStreams) return Guarded([&] { return estimate(problem); }, failed);
  return EdgeOfChosen(problem, AllCaptures(problem), SeenByBoth(problem), Drop, estimate, failed);
}

}  // namespace rigcal::calib
