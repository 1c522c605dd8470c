#include <array>
#include <string_view>

#include "server/calib/eye_to_hand/exchanged_roles.h"
#include "server/model/edges/method.h"

namespace rigcal::calib {
namespace {

constexpr const char* kTurnFlange = "Turn the flange by 20 degrees and more about two different axes between captures.";
constexpr const char* kMoveFlange = "Move the flange to different places between captures. ";
constexpr const char* kTakeMore =
    "Take 20 to 40 captures, the flange in different places and turned differently, with the board in view.";
constexpr const char* kCheckCell =
    "Check that the board sits firm on the flange and the camera on its stand, that pictures and rows of one name are "
    "of one instant, and that poses.csv has the flange in the base (p_base = T * p_flange).";

struct CureOfFlange {
  std::string_view code;
  const char* cure;
};
constexpr std::array<CureOfFlange, 5> kCures = {{{"too_few_captures", kTakeMore},
                                                 {"no_motion", kTurnFlange},
                                                 {"contradicting_motion", kCheckCell},
                                                 {"high_residual", kCheckCell},
                                                 {"inconsistent_captures", kCheckCell}}};

std::string PairText(const HandEyeProblem& problem) {
  return problem.a.sensor.id.str() + " and " + problem.b.sensor.id.str();
}

}  // namespace

Diagnosis OfFlange(Diagnosis diagnosis) {
  for (const CureOfFlange& row : kCures)
    if (diagnosis.code == row.code) diagnosis.cure = row.cure;
  return diagnosis;
}

std::vector<Diagnosis> OpenOfFlange(const HandEyeProblem& problem, const MotionReach& reach) {
  const SensorId &a = problem.a.sensor.id, &b = problem.b.sensor.id;
  const MotionWords words = WordsOf(reach, LineText(reach.axis_a) + " in the frame of " + a.str());
  if (words.code.empty()) return {};
  const char* const unknown = reach.kind == MotionKind::kOneAxis ? "how far {} is from {} along this axis is not known."
                              : reach.kind == MotionKind::kOnTheSpot
                                  ? "where {} is from {} along this line, and how it is turned about it, is not known."
                              : reach.kind == MotionKind::kNoRotation
                                  ? "where {} is from {} is not known, only how it is turned."
                                  : "where {} is from {} is not known, nor how it is turned about this line.";
  const bool turns_missing_only = reach.kind == MotionKind::kOneAxis || reach.kind == MotionKind::kNoRotation;
  return {{words.code, Worded("{}: the flange was {}: ", {PairText(problem), words.moved}) + Worded(unknown, {b, a}),
           turns_missing_only ? std::string(kTurnFlange) : std::string(kMoveFlange) + kTurnFlange}};
}

Diagnosis FewOfFlange(const HandEyeProblem& problem, std::size_t used) {
  constexpr std::size_t kEnough = RowOf(Method::kEyeToHand).captures.enough, kForJackknife = 5;
  return {"few_captures",
          Worded("{} have a pose and the board in only {}; with fewer than {}{}",
                 {PairText(problem), CountText(used), kEnough, FewMeanText(used, kForJackknife)}),
          kTakeMore};
}

Diagnosis BoardStandsStill(const HandEyeProblem& problem) {
  const SensorId& flange = FlangeOf(problem).sensor.id;
  const TargetId& board = CameraOf(problem).board->id;
  return {
      "board_stands_still",
      Worded("{}: the poses fit a target '{}' that stands still while {} carries the camera, not one that is mounted "
             "on {}.",
             {PairText(problem), board, flange, flange}),
      Worded("If it stands still, leave 'mounted_on' of target '{}' away in session.yaml; if it is on the flange, {}"
             "/poses.csv has the base in the flange: write the inverse, p_base = T * p_flange. Then push again.",
             {board, flange})};
}

Diagnosis BoardOnFlange(const HandEyeProblem& problem) {
  const SensorId& flange = FlangeOf(problem).sensor.id;
  const TargetId& board = CameraOf(problem).board->id;
  return {
      "board_on_flange",
      Worded("{}: the poses fit a target '{}' that moves with {} before a camera that stands still, not one that "
             "stands still.",
             {PairText(problem), board, flange}),
      Worded("If {} carries the board, say 'mounted_on: {}' of target '{}' in session.yaml; if it carries the camera, "
             "{}/poses.csv has the world in the body: write the inverse, p_world = T * p_body. Then push again.",
             {flange, flange, board, flange})};
}

}  // namespace rigcal::calib
