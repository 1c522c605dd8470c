#include <iterator>
#include <set>

#include "server/calib/camera/camera_fit.h"
#include "server/calib/core/pair_edge.h"
#include "server/calib/core/selection.h"
#include "server/calib/eye_to_hand/exchanged_roles.h"
#include "server/calib/motion/hand_eye_work.h"

namespace rigcal::calib {
namespace {

std::set<CaptureId> FlangeCaptures(const HandEyeProblem& problem) {
  std::set<CaptureId> captures;
  for (const auto& [capture, view] : CameraOf(problem).views) captures.insert(capture);
  for (const TimedPose& pose : FlangeOf(problem).poses)
    if (!pose.capture.empty()) captures.insert(pose.capture);
  return captures;
}

void DropOfFlange(HandEyeProblem& problem, const std::set<CaptureId>& left_out) {
  for (HandEyeSide* side : {&problem.a, &problem.b}) {
    std::erase_if(side->views, [&](const auto& view) { return left_out.contains(view.first); });
    std::erase_if(side->poses, [&](const TimedPose& pose) { return left_out.contains(pose.capture); });
  }
}

Edge UnsolvedOfFlange(const HandEyeProblem& problem) {
  return UnsolvedEdge(problem.a.sensor.id, problem.b.sensor.id, Method::kEyeToHand, FlangeCaptures(problem).size());
}

void AddFilesOfFlange(const HandEyeProblem& problem, Edge& edge) {
  const std::set<CaptureId> captures = FlangeCaptures(problem);
  const auto place = [&](const CaptureId& capture) {
    return static_cast<std::size_t>(std::distance(captures.begin(), captures.find(capture)));
  };
  const HandEyeSide& camera = CameraOf(problem);
  FilesFound pictures, rows;
  for (const auto& [capture, view] : camera.views)
    pictures.Add(place(capture), view.found || view.image_width_px > 0, camera.board && Sees(view, *camera.board));
  for (const TimedPose& pose : FlangeOf(problem).poses)
    if (!pose.capture.empty()) rows.Add(place(pose.capture), true, true);
  const bool camera_is_a = &camera == &problem.a;
  AddFilesFound(pictures, camera_is_a ? "_a" : "_b", edge);
  AddFilesFound(rows, camera_is_a ? "_b" : "_a", edge);
}

Edge FailedOfFlange(const HandEyeProblem& problem, const std::vector<Diagnosis>& why) {
  Edge edge = UnsolvedOfFlange(problem);
  for (const CaptureId& capture : FlangeCaptures(problem))
    edge.captures.push_back({capture, 0.0, false, "the pair was not solved"});
  AddFilesOfFlange(problem, edge);
  const HandEyeSide& flange = FlangeOf(problem);
  std::vector<Diagnosis> diagnoses;
  if (auto unit = PositionsInMillimetres(flange.sensor.id, flange.poses, &flange == &problem.a ? "_a" : "_b"))
    diagnoses.push_back(std::move(*unit));
  Append(why, diagnoses);
  Append(MissedViews(problem), diagnoses);
  return FailedFor(std::move(diagnoses), std::move(edge));
}

// x y z of T_flange_board, and its rotation vector.
void AddFlangeBoard(const Se3& T_flange_board, Edge& edge) {
  const Vector6d xi = Se3{Eigen::Vector3d::Zero(), T_flange_board.q}.Log();
  constexpr const char* kAxes[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i) {
    edge.figures[std::string("flange_board_") + kAxes[i] + "_m"] = T_flange_board.p_m[i];
    edge.figures[std::string("flange_board_r") + kAxes[i] + "_rad"] = xi[3 + i];
  }
}

void AddFiguresOfFlange(const HandEyeProblem& problem, const EyeToHandEstimate& estimate, Edge& edge) {
  edge.figures["captures_used"] = static_cast<double>(estimate.rms_px.size());
  edge.figures["rms_px"] = estimate.all_rms_px;
  edge.figures["motion_rms_m"] = estimate.motion_rms_m;
  edge.figures["motion_rms_rad"] = estimate.motion_rms_rad;
  edge.figures["noise_a_m"] = estimate.noise_a.translation_m;
  edge.figures["noise_a_rad"] = estimate.noise_a.rotation_rad;
  edge.figures["noise_b_m"] = estimate.noise_b.translation_m;
  edge.figures["noise_b_rad"] = estimate.noise_b.rotation_rad;
  AddFlangeBoard(estimate.T_flange_board, edge);
  AddMotionFigures(estimate.reach, edge);
  if (estimate.reach.open.cols() > 0) AddAxisFigures(estimate.reach.axis_a, edge);
  if (!estimate.board_scale) return;
  edge.figures["board_scale_ratio"] = estimate.board_scale->ratio;
  edge.figures["board_scale_sigma_ratio"] = estimate.board_scale->sigma_ratio;
  edge.figures["board_square_m"] = CameraOf(problem).board->square_m;
}

void AddCapturesOfFlange(const HandEyeProblem& problem, const EyeToHandEstimate& estimate, Edge& edge) {
  for (const CaptureId& capture : FlangeCaptures(problem)) {
    const auto rms = estimate.rms_px.find(capture);
    const auto why = estimate.unused.find(capture);
    if (rms != estimate.rms_px.end())
      edge.captures.push_back({capture, rms->second, true, {}});
    else
      edge.captures.push_back({capture, 0.0, false, why == estimate.unused.end() ? "no pose" : why->second});
  }
}

std::vector<CameraFit> FitsOfFlange(const HandEyeProblem& problem, const CameraEstimate* camera) {
  const HandEyeSide& side = CameraOf(problem);
  if (!side.board) return {};
  return {FitOrSeen({side.sensor, *side.board, side.views}, camera)};
}

std::optional<Diagnosis> WhyRefusedOfFlange(const HandEyeProblem& problem, const EyeToHandEstimate& estimate) {
  if (estimate.board_scale && estimate.board_scale->Contradicts(*CameraOf(problem).board))
    return MotionOfOtherSize(problem, *estimate.board_scale);
  if (IsWithinNoise(estimate.motion_rms_m, estimate.motion_rms_rad)) return std::nullopt;
  HandEyeEstimate motion;
  motion.rms_m = estimate.motion_rms_m;
  motion.rms_rad = estimate.motion_rms_rad;
  return OfFlange(HighMotionResidual(problem, motion));
}

Edge FailedOrReadWrong(const HandEyeProblem& problem, const Diagnosis& why) {
  std::vector<Diagnosis> diagnoses;
  if (MayBeReadOtherwise(why.code) && FitsBoardThatStandsStill(problem)) diagnoses.push_back(BoardStandsStill(problem));
  diagnoses.push_back(why);
  return FailedOfFlange(problem, diagnoses);
}

// Noise that a wrong reading makes of motion hides what the motion tells.
bool IsReadWrong(const HandEyeProblem& problem, const Uncertainty& uncertainty) {
  return uncertainty.rank < 6 && FitsBoardThatStandsStill(problem);
}

Edge SolvedOfFlange(const HandEyeProblem& problem, std::vector<CameraFit>* fits) {
  if (fits) *fits = FitsOfFlange(problem, nullptr);
  auto result = EstimateEyeToHand(problem);
  if (!result) return FailedOrReadWrong(problem, result.error());
  if (fits) *fits = FitsOfFlange(problem, &result->camera);
  const EyeToHandEstimate& estimate = result->estimate;
  if (const auto refused = WhyRefusedOfFlange(problem, estimate)) {
    Edge edge = FailedOrReadWrong(problem, *refused);
    AddFiguresOfFlange(problem, estimate, edge);
    return edge;
  }
  if (IsReadWrong(problem, result->uncertainty)) return FailedOfFlange(problem, {BoardStandsStill(problem)});
  Edge edge = Good(estimate.T_a_b, std::move(result->uncertainty), std::move(result->notes), UnsolvedOfFlange(problem));
  if (estimate.rms_px.size() < RowOf(Method::kEyeToHand).captures.enough)
    edge.diagnoses.push_back(FewOfFlange(problem, estimate.rms_px.size()));
  Append(TakenAsExact(problem), edge.diagnoses);
  Append(MissedViews(problem), edge.diagnoses);
  AddCapturesOfFlange(problem, estimate, edge);
  AddFiguresOfFlange(problem, estimate, edge);
  AddFilesOfFlange(problem, edge);
  return edge;
}

}  // namespace

Edge EstimateEyeToHandEdge(const HandEyeProblem& problem, std::vector<CameraFit>* fits) {
  const auto estimate = [&](const HandEyeProblem& chosen) { return SolvedOfFlange(chosen, fits); };
  const auto failed = [&](const Error& error) { return FailedOfFlange(problem, {MotionNotSolvable(problem, error)}); };
  return EdgeOfChosen(problem, FlangeCaptures(problem), WithPoseAndBoard(problem), DropOfFlange, estimate, failed);
}

}  // namespace rigcal::calib
