#include "server/calib/hand_eye_diagnoses.h"

#include <cstdio>

#include "server/calib/diagnoses.h"
#include "server/calib/hand_eye_work.h"
#include "server/calib/lidar_camera_diagnoses.h"
#include "server/calib/seen_corners.h"

namespace rigcal::calib {
namespace {

std::string PairOf(const HandEyeProblem& problem) {
  return problem.a.sensor.id.str() + " and " + problem.b.sensor.id.str();
}

std::string CountText(std::size_t count) { return std::to_string(count) + (count == 1 ? " capture" : " captures"); }
std::string OnlyCountText(std::size_t count) { return count == 0 ? "no capture" : "only " + CountText(count); }

std::string DegreesOf(double value_rad) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f deg", value_rad * 180 / M_PI);
  return text;
}

std::string AxisText(const Eigen::Vector3d& axis) {
  char text[64];
  std::snprintf(text, sizeof text, "(%.3f, %.3f, %.3f)", axis.x(), axis.y(), axis.z());
  return text;
}

}  // namespace

Diagnosis TooFewMotions(const HandEyeProblem& problem, std::size_t both) {
  return {"too_few_captures",
          PairOf(problem) + " have a pose each in " + OnlyCountText(both) + "; at least " +
              std::to_string(kHandEyeMin) + " are needed.",
          "Take 20 to 40 captures from different places, turned differently, with each sensor's board in view."};
}

Diagnosis FewMotions(const HandEyeProblem& problem, std::size_t used) {
  return {"few_captures",
          PairOf(problem) + " have a pose each in only " + CountText(used) + "; with fewer than " +
              std::to_string(kHandEyeEnough) +
              (used < kHandEyeForJackknife ? " the uncertainty comes from the model alone and is probably too small."
                                           : " the uncertainty is itself uncertain."),
          "Take 20 to 40 captures from different places, turned differently."};
}

Diagnosis CameraFailed(const HandEyeProblem& problem, const HandEyeSide& side, const Diagnosis& why) {
  return {why.code, PairOf(problem) + ": " + side.sensor.id.str() + " gives no poses: " + why.what, why.cure};
}

Diagnosis MotionsContradict(const HandEyeProblem& problem, std::size_t captures) {
  return {
      "contradicting_motion",
      PairOf(problem) + ": no rigid connection of the two explains most of their " + CountText(captures) + ".",
      "Check that boards and tracker stood still, that files and rows of one name are of one instant, and that each "
      "camera's board is named right."};
}

Diagnosis CapturesContradict(const HandEyeProblem& problem, const std::vector<CaptureId>& captures) {
  return {"inconsistent_captures",
          PairOf(problem) + ": " + NamesOf(captures) + " contradict the other captures; they are not used.",
          "Check that the board did not move, and that their names were not swapped."};
}

Diagnosis MotionNotSolvable(const HandEyeProblem& problem, const Error& error) {
  return {"ill_conditioned", PairOf(problem) + ": " + error.what + ".", error.cure};
}

Diagnosis HighMotionResidual(const HandEyeProblem& problem, const HandEyeEstimate& estimate) {
  return {"high_residual",
          PairOf(problem) + " disagree about their motion by " + MillimetresText(estimate.rms_m) + " and " +
              DegreesOf(estimate.rms_rad) + " rms.",
          "Check that boards and tracker stood still, the boards' sizes, and that given intrinsics belong to these "
          "cameras."};
}

Diagnosis NoMotion(const HandEyeProblem& problem) {
  return {"no_motion", PairOf(problem) + " did not move between the captures by more than the noise.",
          "Move and turn the robot between captures."};
}

std::vector<Diagnosis> OpenDirections(const HandEyeProblem& problem, const MotionReach& reach) {
  const std::string a = problem.a.sensor.id.str(), b = problem.b.sensor.id.str();
  const std::string axis = AxisText(reach.axis_a) + " in the frame of " + a;
  const std::string tilt =
      "to within " + DegreesOf(reach.tilt_rad) + " (noise " + DegreesOf(reach.tilt_noise_rad) + ")";
  switch (reach.kind) {
    case MotionKind::kOneAxis:
      return {{"planar_motion",
               PairOf(problem) + " were turned about one axis only, " + axis + ", " + tilt + ": how far " + b +
                   " is from " + a + " along this axis is not known.",
               kTurnMore}};
    case MotionKind::kOnTheSpot:
      return {{"turning_on_the_spot",
               PairOf(problem) + " were turned about one fixed line only, along " + axis + ", " + tilt + ": where " +
                   b + " is along this line, and how it is turned about it, is not known.",
               "Drive the robot to different places between captures. " + std::string(kTurnMore)}};
    case MotionKind::kNoRotation:
      return {{"pure_translation",
               PairOf(problem) + " were moved but not turned: how " + b + " is turned is known, where it is from " + a +
                   " is not.",
               kTurnMore}};
    case MotionKind::kOneLine:
      return {{"straight_line",
               PairOf(problem) + " were moved along one line only, " + axis + ", and not turned: where " + b +
                   " is from " + a + " is not known, nor how it is turned about this line.",
               kTurnMore}};
    case MotionKind::kGeneral:
    case MotionKind::kStill:
      break;
  }
  return {};
}

std::vector<Diagnosis> MissedViews(const HandEyeProblem& problem) {
  std::vector<Diagnosis> diagnoses;
  for (const HandEyeSide* side : {&problem.a, &problem.b}) {
    if (!side->board) continue;
    std::vector<CaptureId> unreadable, without;
    std::string first;
    for (const auto& [capture, view] : side->views) {
      const std::string why = WhyUnusable(view, *side->board);
      if (why.empty()) continue;
      const bool readable = view.found || view.image_width_px > 0;
      if (first.empty()) first = " The first of them: " + why + (why.back() == '.' ? "" : ".");
      (readable ? without : unreadable).push_back(capture);
    }
    if (!unreadable.empty()) diagnoses.push_back(Unreadable(side->sensor.id, unreadable, ""));
    if (!without.empty())
      diagnoses.push_back({"board_not_found",
                           side->sensor.id.str() + " does not show target '" + side->board->id.str() + "' in " +
                               CountText(without.size()) + ": " + NamesOf(without) + "." + first,
                           "Show the whole board, sharp and evenly lit, and check its description in session.yaml."});
  }
  return diagnoses;
}

std::vector<Diagnosis> TakenAsExact(const HandEyeProblem& problem) {
  std::vector<Diagnosis> notes;
  for (const HandEyeSide* side : {&problem.a, &problem.b}) {
    if (!side->board) continue;
    if (side->sensor.intrinsics && !side->sensor.intrinsics_sigma)
      notes.push_back(IntrinsicsTakenAsExact(side->sensor.id));
    if (!(side->board->square_sigma_m > 0))
      notes.push_back({"board_size_taken_as_exact",
                       "The size of target '" + side->board->id.str() +
                           "' is given without an uncertainty and taken as "
                           "exact.",
                       "Give 'square_size_sigma_m' in session.yaml."});
  }
  return notes;
}

Diagnosis NoCommonTime(const HandEyeProblem& problem, double correlation_ratio) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", correlation_ratio);
  return {"no_common_time",
          PairOf(problem) + ": no offset of their clocks makes their turning agree (best correlation " + text + ").",
          "Record both at the same time, for half a minute or more, and turn the robot to and fro."};
}

}  // namespace rigcal::calib
