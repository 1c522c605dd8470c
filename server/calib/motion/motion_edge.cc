#include "server/calib/motion/motion_edge.h"

#include <iterator>

#include "server/calib/core/pair_edge.h"
#include "server/calib/core/selection.h"
#include "server/calib/motion/hand_eye_work.h"

namespace rigcal::calib {
namespace {

FilesFound FilesOfSide(const HandEyeSide& side, const std::set<CaptureId>& captures) {
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

void AddNoise(const std::string& side, const SideNoise& noise, Edge& edge) {
  edge.figures["noise_" + side + "_m"] = noise.translation_m;
  edge.figures["noise_" + side + "_rad"] = noise.rotation_rad;
}

void AddBoardScale(const HandEyeProblem& problem, const BoardScale& scale, Edge& edge) {
  edge.figures["board_scale_ratio"] = scale.ratio;
  edge.figures["board_scale_sigma_ratio"] = scale.sigma_ratio;
  edge.figures["board_square_m"] = SideWithBoard(problem).board->square_m;
}

}  // namespace

std::set<CaptureId> CapturesOfSides(const HandEyeProblem& problem) {
  std::set<CaptureId> captures;
  for (const HandEyeSide* side : {&problem.a, &problem.b}) {
    for (const auto& [capture, view] : side->views) captures.insert(capture);
    for (const TimedPose& pose : side->poses)
      if (!pose.capture.empty()) captures.insert(pose.capture);
  }
  return captures;
}

void DropFromSides(HandEyeProblem& problem, const std::set<CaptureId>& left_out) {
  for (HandEyeSide* side : {&problem.a, &problem.b}) {
    std::erase_if(side->views, [&](const auto& view) { return left_out.contains(view.first); });
    std::erase_if(side->poses, [&](const TimedPose& pose) { return left_out.contains(pose.capture); });
  }
}

Edge UnsolvedMotionEdge(const HandEyeProblem& problem) {
  Edge edge = UnsolvedEdge(problem.a.sensor.id, problem.b.sensor.id, problem.method, CapturesOfSides(problem).size());
  if (problem.method == Method::kPoseStreams) edge.figures.clear();
  return edge;
}

Edge FailedMotionEdge(const HandEyeProblem& problem, std::vector<Diagnosis> why) {
  Edge edge = UnsolvedMotionEdge(problem);
  for (const CaptureId& capture : CapturesOfSides(problem))
    edge.captures.push_back({capture, 0.0, false, "the pair was not solved"});
  AddFilesOfSides(problem, edge);
  std::vector<Diagnosis> diagnoses;
  for (const auto& [side, name] : {std::pair{&problem.a, "_a"}, {&problem.b, "_b"}})
    if (auto unit = PositionsInMillimetres(side->sensor.id, side->poses, name)) diagnoses.push_back(std::move(*unit));
  Append(std::move(why), diagnoses);
  Append(MissedViews(problem), diagnoses);
  return FailedFor(std::move(diagnoses), std::move(edge));
}

void AddFilesOfSides(const HandEyeProblem& problem, Edge& edge) {
  if (problem.method == Method::kPoseStreams) return;
  const std::set<CaptureId> captures = CapturesOfSides(problem);
  AddFilesFound(FilesOfSide(problem.a, captures), "_a", edge);
  AddFilesFound(FilesOfSide(problem.b, captures), "_b", edge);
}

void AddCapturesOfSides(const HandEyeProblem& problem,
                        const std::function<std::optional<double>(const CaptureId&)>& residual,
                        const std::map<CaptureId, std::string>& unused, Edge& edge) {
  for (const CaptureId& capture : CapturesOfSides(problem)) {
    const auto why = unused.find(capture);
    if (const auto rms = residual(capture))
      edge.captures.push_back({capture, *rms, true, {}});
    else
      edge.captures.push_back({capture, 0.0, false, why == unused.end() ? "no pose" : why->second});
  }
}

void AddMotionMetrics(const HandEyeProblem& problem, const MotionMetrics& metrics, Edge& edge) {
  edge.figures["motion_rms_m"] = metrics.rms_m;
  edge.figures["motion_rms_rad"] = metrics.rms_rad;
  AddNoise("a", metrics.noise_a, edge);
  AddNoise("b", metrics.noise_b, edge);
  AddMotionFigures(metrics.reach, edge);
  if (metrics.reach.open.cols() > 0) AddAxisFigures(metrics.reach.axis_a, edge);
  if (metrics.board_scale) AddBoardScale(problem, *metrics.board_scale, edge);
}

}  // namespace rigcal::calib
