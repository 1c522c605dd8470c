#include <algorithm>
#include <cmath>
#include <cstdio>

#include "server/calib/camera/camera_diagnoses.h"
#include "server/calib/camera/seen_corners.h"
#include "server/calib/core/wording.h"
#include "server/calib/motion/hand_eye_work.h"
#include "server/calib/motion/stream_motion.h"

namespace rigcal::calib {
namespace {

constexpr double kRecordingEnough_s = 30.0, kTurnEnough_rad = 20 * M_PI / 180;
constexpr const char* kRecordLonger = "Record both at the same time, for half a minute or more.";

std::string PairOf(const HandEyeProblem& problem) {
  return problem.a.sensor.id.str() + " and " + problem.b.sensor.id.str();
}

std::string DegreesOf(double value_rad) { return Formatted("%.2f deg", value_rad * 180 / M_PI); }
std::string SecondsText(double value_s) { return Formatted(value_s < 100 ? "%.1f s" : "%.0f s", value_s); }

bool OfStreams(const HandEyeProblem& problem) { return problem.method == Method::kPoseStreams; }

std::string AxisText(const Eigen::Vector3d& axis) {
  char text[64];
  std::snprintf(text, sizeof text, "(%.3f, %.3f, %.3f)", axis.x(), axis.y(), axis.z());
  return text;
}

}  // namespace

Diagnosis TooFewMotions(const HandEyeProblem& problem, std::size_t both, std::size_t repeated) {
  if (repeated > 0)
    return {"too_few_captures",
            Worded("{} have a pose each in {}, but {} of them repeat{} the pose of another; at least {} different ones "
                   "are needed.",
                   {PairOf(problem), CountText(both + repeated), repeated, repeated == 1 ? "s" : "", kHandEyeMin}),
            "Move and turn the robot between captures."};
  return {"too_few_captures",
          Worded("{} have a pose each in {}; at least {} are needed.",
                 {PairOf(problem), OnlyCapturesText(both), kHandEyeMin}),
          "Take 20 to 40 captures from different places, turned differently, with each sensor's board in view."};
}

Diagnosis TooFewSamples(const HandEyeProblem& problem, std::size_t samples, std::size_t needed, double common_s) {
  return {
      "too_few_poses",
      Worded("{} have poses of the same time at only {} of their path, in the {} that both recorded; at least {} "
             "are needed.",
             {PairOf(problem), CountText(samples, "place"), SecondsText(common_s), needed}),
      common_s < kRecordingEnough_s
          ? kRecordLonger
          : Worded("Record ten or more poses a second of each, without gaps of more than {}, while the robot drives "
                   "and turns.",
                   {SecondsText(kStreamGapMax_s)})};
}

Diagnosis FewMotions(const HandEyeProblem& problem, std::size_t used) {
  return {"few_captures",
          Worded("{} have a pose each in only {}; with fewer than {}{}",
                 {PairOf(problem), CountText(used), kHandEyeEnough, FewMeanText(used, kHandEyeForJackknife)}),
          "Take 20 to 40 captures from different places, turned differently."};
}

Diagnosis CameraFailed(const HandEyeProblem& problem, const HandEyeSide& side, const Diagnosis& why) {
  Diagnosis of_pair = OfSide(why, &side == &problem.a ? "_a" : "_b");
  of_pair.what = Worded("{}: {} gives no poses: {}", {PairOf(problem), side.sensor.id, why.what});
  return of_pair;
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
          Worded("{}: {} contradict the other captures; they are not used.", {PairOf(problem), NamesOf(captures)}),
          "Check that the board did not move, and that their names were not swapped."};
}

Diagnosis MotionNotSolvable(const HandEyeProblem& problem, const Error& error) {
  return AsDiagnosis(PairOf(problem), "ill_conditioned", error);
}

Diagnosis HighMotionResidual(const HandEyeProblem& problem, const HandEyeEstimate& estimate) {
  return {"high_residual",
          Worded("{} disagree about their motion by {} and {} rms.",
                 {PairOf(problem), MillimetresText(estimate.rms_m), DegreesOf(estimate.rms_rad)}),
          "Check that boards and tracker stood still, the boards' sizes, and that given intrinsics belong to these "
          "cameras."};
}

Diagnosis MotionOfOtherSize(const HandEyeProblem& problem, const BoardScale& scale) {
  return OtherBoardSize(*SideWithBoard(problem).board, scale.ratio, scale.sigma_ratio,
                        "the motions of " + PairOf(problem), "tracker");
}

Diagnosis NoMotion(const HandEyeProblem& problem) {
  const bool streams = OfStreams(problem);
  return {"no_motion",
          Worded("{} did not move {} by more than the noise.",
                 {PairOf(problem), streams ? "while both recorded" : "between the captures"}),
          Worded("Move and turn the robot {}", {streams ? "while both record." : "between captures."})};
}

std::vector<Diagnosis> OpenDirections(const HandEyeProblem& problem, const MotionReach& reach) {
  const SensorId &a = problem.a.sensor.id, &b = problem.b.sensor.id;
  const MotionWords words = WordsOf(reach, AxisText(reach.axis_a) + " in the frame of " + a.str());
  if (words.code.empty()) return {};
  const char* const unknown = reach.kind == MotionKind::kOneAxis ? "how far {} is from {} along this axis is not known."
                              : reach.kind == MotionKind::kOnTheSpot
                                  ? "where {} is along this line, and how it is turned about it, is not known."
                              : reach.kind == MotionKind::kNoRotation
                                  ? "how {} is turned is known, where it is from {} is not."
                                  : "where {} is from {} is not known, nor how it is turned about this line.";
  return {{words.code, Worded("{} were {}: ", {PairOf(problem), words.moved}) + Worded(unknown, {b, a}), words.cure}};
}

std::vector<Diagnosis> MissedViews(const HandEyeProblem& problem) {
  std::vector<Diagnosis> diagnoses;
  for (const HandEyeSide* side : {&problem.a, &problem.b}) {
    if (!side->board) continue;
    MissedCaptures unreadable, other_layout, without;
    std::string first;
    for (const auto& [capture, view] : side->views) {
      const std::string why = WhyUnusable(view, *side->board);
      if (why.empty()) continue;
      const bool readable = view.found || view.image_width_px > 0;
      (ShowsOtherLayout(view) ? other_layout : readable ? without : unreadable).Add(capture, "");
      if (!ShowsOtherLayout(view) && first.empty()) first = FirstReason(why);
    }
    without.first_reason = first;
    const SensorId& camera = side->sensor.id;
    if (!other_layout.captures.empty()) diagnoses.push_back(OtherLayout(camera, *side->board, other_layout.captures));
    if (!unreadable.captures.empty()) diagnoses.push_back(Unreadable(camera, unreadable));
    if (!without.captures.empty())
      diagnoses.push_back(BoardNotFound(camera, "target '" + side->board->id.str() + "'", without));
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
      notes.push_back(
          {"board_size_taken_as_exact",
           Worded("The size of target '{}' is given without an uncertainty and taken as exact.", {side->board->id}),
           "Give 'square_size_sigma_m' (of tags 'tag_size_sigma_m', of circles 'spacing_sigma_m') in session.yaml."});
  }
  return notes;
}

Diagnosis NoCommonTime(const HandEyeProblem& problem, double correlation_ratio) {
  const StreamSpan a = SpanOf(problem.a.poses), b = SpanOf(problem.b.poses);
  const auto whole_degrees = [](double angle_rad) { return Formatted("%.0f", angle_rad * 180 / M_PI); };
  const std::string cure =
      std::min(a.seconds, b.seconds) < kRecordingEnough_s ? std::string(kRecordLonger) + " Turn the robot to and fro."
      : std::min(a.turn_rad, b.turn_rad) < kTurnEnough_rad
          ? "Turn the robot to and fro, by 20 degrees and more, while both record."
          : "Check that both are of the same drive and their stamps in nanoseconds, and turn the robot to and fro at "
            "changing speed while both record.";
  return {"no_common_time",
          Worded("{}: no offset of their clocks makes their turning agree (best correlation {}; {} and {} long, turned "
                 "by up to {} and {} deg).",
                 {PairOf(problem), Formatted("%.2f", correlation_ratio), SecondsText(a.seconds), SecondsText(b.seconds),
                  whole_degrees(a.turn_rad), whole_degrees(b.turn_rad)}),
          cure};
}

}  // namespace rigcal::calib
