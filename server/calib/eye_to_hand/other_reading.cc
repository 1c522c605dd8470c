// A pair that fails is read the other way: a board that stands still for one on the flange, and the reverse.
#include <algorithm>
#include <set>

#include "server/calib/core/pair_edge.h"
#include "server/calib/eye_to_hand/exchanged_roles.h"
#include "server/calib/motion/hand_eye_work.h"

namespace rigcal::calib {
namespace {

// Residuals beyond these mean that something is wrong, not noisy.
constexpr double kFlangeRmsMax_m = 0.1, kFlangeRmsMax_rad = 0.05;
constexpr std::size_t kOtherReadingMin = kHandEyeMin + 2;  // captures: as many do not fit by chance

// Whether most captures agree, and all of the pose is told.
bool Fits(const HandEyeProblem& problem, const Uncertainty& uncertainty, std::size_t used, double rms_m,
          double rms_rad) {
  const std::size_t both = WithPoseAndBoard(problem).size();
  return used >= kOtherReadingMin && 5 * used >= 4 * both && uncertainty.rank == 6 && IsWithinNoise(rms_m, rms_rad);
}

bool FitsBoardOnFlange(HandEyeProblem problem) {
  problem.method = Method::kEyeToHand;
  const auto result = EstimateEyeToHand(problem);
  return result && Fits(problem, result->uncertainty, result->estimate.rms_px.size(), result->estimate.motion_rms_m,
                        result->estimate.motion_rms_rad);
}

}  // namespace

std::set<CaptureId> WithPoseAndBoard(const HandEyeProblem& problem) {
  std::set<CaptureId> placed, both;
  for (const TimedPose& pose : FlangeOf(problem).poses) placed.insert(pose.capture);
  for (const auto& [capture, view] : CameraOf(problem).views)
    if (view.found && placed.contains(capture)) both.insert(capture);
  return both;
}

bool IsWithinNoise(double rms_m, double rms_rad) { return rms_m <= kFlangeRmsMax_m && rms_rad <= kFlangeRmsMax_rad; }

bool FitsBoardThatStandsStill(HandEyeProblem problem) {
  problem.method = Method::kTrackerCamera;
  const auto result = EstimateHandEye(problem);
  return result && Fits(problem, result->uncertainty, result->estimate.captures, result->estimate.rms_m,
                        result->estimate.rms_rad);
}

bool MayBeReadOtherwise(const std::string& code) {
  return code == "no_motion" || code == "contradicting_motion" || code == "high_residual" ||
         code == "ill_conditioned" || code == "board_size_suspected";
}

Edge EstimateTrackerCameraEdge(const HandEyeProblem& problem, std::vector<CameraFit>* fits) {
  Edge edge = EstimateHandEyeEdge(problem, fits);
  const auto may_be = [](const Diagnosis& why) { return MayBeReadOtherwise(why.code); };
  if (edge.state == EdgeState::kGood || std::none_of(edge.diagnoses.begin(), edge.diagnoses.end(), may_be)) return edge;
  const auto reread = [&] {
    if (FitsBoardOnFlange(problem)) edge.diagnoses.insert(edge.diagnoses.begin(), BoardOnFlange(problem));
    return edge;
  };
  return Guarded(reread, [&](const Error&) { return edge; });
}

}  // namespace rigcal::calib
