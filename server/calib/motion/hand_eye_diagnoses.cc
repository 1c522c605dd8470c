#include "server/calib/motion/hand_eye_diagnoses.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "server/calib/camera/camera_diagnoses.h"
#include "server/calib/camera/seen_corners.h"
#include "server/calib/core/diagnoses.h"
#include "server/calib/lidar_camera/lidar_camera_diagnoses.h"
#include "server/calib/motion/hand_eye_work.h"
#include "server/calib/motion/stream_motion.h"

namespace rigcal::calib {
namespace {

constexpr double kRecordingEnough_s = 30.0, kTurnEnough_rad = 20 * M_PI / 180;
constexpr const char* kRecordLonger = "Record both at the same time, for half a minute or more.";

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

std::string SecondsText(double value_s) {
  char text[32];
  std::snprintf(text, sizeof text, value_s < 100 ? "%.1f s" : "%.0f s", value_s);
  return text;
}

bool OfStreams(const HandEyeProblem& problem) { return problem.method == Method::kPoseStreams; }

std::string AxisText(const Eigen::Vector3d& axis) {
  char text[64];
  std::snprintf(text, sizeof text, "(%.3f, %.3f, %.3f)", axis.x(), axis.y(), axis.z());
  return text;
}

}  // namespace

Diagnosis TooFewMotions(const HandEyeProblem& problem, std::size_t both, std::size_t repeated) {
  const std::string needed = "; at least " + std::to_string(kHandEyeMin);
  if (repeated > 0)
    return {"too_few_captures",
            PairOf(problem) + " have a pose each in " + CountText(both + repeated) + ", but " +
                std::to_string(repeated) + " of them repeat" + (repeated == 1 ? "s" : "") + " the pose of another" +
                needed + " different ones are needed.",
            "Move and turn the robot between captures."};
  return {"too_few_captures", PairOf(problem) + " have a pose each in " + OnlyCountText(both) + needed + " are needed.",
          "Take 20 to 40 captures from different places, turned differently, with each sensor's board in view."};
}

Diagnosis TooFewSamples(const HandEyeProblem& problem, std::size_t samples, std::size_t needed, double common_s) {
  const std::string cure = common_s < kRecordingEnough_s
                               ? std::string(kRecordLonger)
                               : "Record ten or more poses a second of each, without gaps of more than " +
                                     SecondsText(kStreamGapMax_s) + ", while the robot drives and turns.";
  return {"too_few_poses",
          PairOf(problem) + " have poses of the same time at only " + std::to_string(samples) +
              (samples == 1 ? " place" : " places") + " of their path, in the " + SecondsText(common_s) +
              " that both recorded; at least " + std::to_string(needed) + " are needed.",
          cure};
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
  const std::string none = PairOf(problem) + ": no rigid connection of the two explains most of their ";
  if (OfStreams(problem))
    return {"contradicting_motion", none + std::to_string(captures) + " common poses.",
            "Check that both are of one rigid body, in the frames that session.yaml names, and that neither jumps."};
  return {
      "contradicting_motion", none + CountText(captures) + ".",
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
  const bool streams = OfStreams(problem);
  return {"no_motion",
          PairOf(problem) + " did not move " + (streams ? "while both recorded" : "between the captures") +
              " by more than the noise.",
          std::string("Move and turn the robot ") + (streams ? "while both record." : "between captures.")};
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
    std::vector<CaptureId> unreadable, other_layout, without;
    std::string first;
    for (const auto& [capture, view] : side->views) {
      const std::string why = WhyUnusable(view, *side->board);
      if (why.empty()) continue;
      if (ShowsOtherLayout(view)) {
        other_layout.push_back(capture);
        continue;
      }
      const bool readable = view.found || view.image_width_px > 0;
      if (first.empty()) first = " The first of them: " + why + (why.back() == '.' ? "" : ".");
      (readable ? without : unreadable).push_back(capture);
    }
    if (!other_layout.empty()) diagnoses.push_back(OtherLayout(side->sensor.id, *side->board, other_layout));
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
  const StreamSpan a = SpanOf(problem.a.poses), b = SpanOf(problem.b.poses);
  char text[160];
  std::snprintf(text, sizeof text, "best correlation %.2f; %s and %s long, turned by up to %.0f and %.0f deg",
                correlation_ratio, SecondsText(a.seconds).c_str(), SecondsText(b.seconds).c_str(),
                a.turn_rad * 180 / M_PI, b.turn_rad * 180 / M_PI);
  const std::string cure =
      std::min(a.seconds, b.seconds) < kRecordingEnough_s ? std::string(kRecordLonger) + " Turn the robot to and fro."
      : std::min(a.turn_rad, b.turn_rad) < kTurnEnough_rad
          ? "Turn the robot to and fro, by 20 degrees and more, while both record."
          : "Check that both are of the same drive and their stamps in nanoseconds, and turn the robot to and fro at "
            "changing speed while both record.";
  return {"no_common_time", PairOf(problem) + ": no offset of their clocks makes their turning agree (" + text + ").",
          cure};
}

}  // namespace rigcal::calib
