#include "server/calib/camera/camera_fit.h"
#include "server/calib/core/pair_edge.h"
#include "server/calib/eye_to_hand/exchanged_roles.h"
#include "server/calib/motion/hand_eye_work.h"
#include "server/calib/motion/motion_edge.h"

namespace rigcal::calib {
namespace {

// x y z of T_flange_board, and its rotation vector.
void AddFlangeBoard(const Se3& T_flange_board, Edge& edge) {
  const Vector6d xi = Se3{Eigen::Vector3d::Zero(), T_flange_board.q}.Log();
  constexpr const char* kAxes[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i) {
    edge.figures[std::string("flange_board_") + kAxes[i] + "_m"] = T_flange_board.p_m[i];
    edge.figures[std::string("flange_board_r") + kAxes[i] + "_rad"] = xi[3 + i];
  }
}

void AddMetricsOfFlange(const HandEyeProblem& problem, const EyeToHandEstimate& estimate, Edge& edge) {
  edge.figures["captures_used"] = static_cast<double>(estimate.rms_px.size());
  edge.figures["rms_px"] = estimate.all_rms_px;
  AddMotionMetrics(problem,
                   {estimate.motion_rms_m, estimate.motion_rms_rad, estimate.noise_a, estimate.noise_b, estimate.reach,
                    estimate.board_scale},
                   edge);
  AddFlangeBoard(estimate.T_flange_board, edge);
}

void AddCapturesOfFlange(const HandEyeProblem& problem, const EyeToHandEstimate& estimate, Edge& edge) {
  const auto rms_px = [&](const CaptureId& capture) -> std::optional<double> {
    const auto found = estimate.rms_px.find(capture);
    return found == estimate.rms_px.end() ? std::nullopt : std::optional(found->second);
  };
  AddCapturesOfSides(problem, rms_px, estimate.unused, edge);
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
  return FailedMotionEdge(problem, diagnoses);
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
    AddMetricsOfFlange(problem, estimate, edge);
    return edge;
  }
  if (IsReadWrong(problem, result->uncertainty)) return FailedMotionEdge(problem, {BoardStandsStill(problem)});
  Edge edge =
      Good(estimate.T_a_b, std::move(result->uncertainty), std::move(result->notes), UnsolvedMotionEdge(problem));
  if (estimate.rms_px.size() < RowOf(Method::kEyeToHand).captures.enough)
    edge.diagnoses.push_back(FewOfFlange(problem, estimate.rms_px.size()));
  Append(TakenAsExact(problem), edge.diagnoses);
  Append(MissedViews(problem), edge.diagnoses);
  AddCapturesOfFlange(problem, estimate, edge);
  AddMetricsOfFlange(problem, estimate, edge);
  AddFilesOfSides(problem, edge);
  return edge;
}

}  // namespace

Edge EstimateEyeToHandEdge(const HandEyeProblem& problem, std::vector<CameraFit>* fits) {
  const auto estimate = [&](const HandEyeProblem& chosen) { return SolvedOfFlange(chosen, fits); };
  const auto failed = [&](const Error& error) {
    return FailedMotionEdge(problem, {MotionNotSolvable(problem, error)});
  };
  return EdgeOfChosen(problem, CapturesOfSides(problem), WithPoseAndBoard(problem), DropFromSides, estimate, failed);
}

}  // namespace rigcal::calib
