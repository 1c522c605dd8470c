#include <cmath>

#include "server/calib/core/wording.h"
#include "server/calib/tracker_lidar/tracker_lidar_work.h"

namespace rigcal::calib {
namespace {

constexpr const char* kTakeMore =
    "Take 20 to 40 captures from different places, turned differently, with boards that stand still in the lidar's "
    "view.";

std::string PairOf(const TrackerLidarProblem& problem) {
  return problem.tracker.id.str() + " and " + problem.lidar.id.str();
}

std::string BoardsOf(const TrackerLidarProblem& problem) {
  std::string names;
  for (const Target& board : problem.boards) names += (names.empty() ? "'" : ", '") + board.id.str() + "'";
  return names.empty() ? "a board" : "a board like " + names;
}

// A line has no sign: its largest part is taken as positive.
std::string AxisText(const Eigen::Vector3d& axis) {
  int largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  std::string text;
  for (int i = 0; i < 3; ++i) {
    const double value = std::round(1e3 * (axis[largest] < 0 ? -axis[i] : axis[i])) / 1e3;
    text += (i == 0 ? "(" : ", ") + Formatted("%.3f", value == 0 ? 0.0 : value);
  }
  return text + ")";
}

// "(0, 0, 1) in its frame" or "(1, 0, 0) and (0, 1, 0) in its frame".
std::string ListOf(const std::vector<Eigen::Vector3d>& axes) {
  std::string text;
  for (std::size_t i = 0; i < axes.size(); ++i)
    text += (i == 0 ? "" : i + 1 == axes.size() ? " and " : ", ") + AxisText(axes[i]);
  return text + " in its frame";
}

std::string OpenText(const std::string& lidar, const std::string& body, const OpenAxes& axes) {
  std::string text;
  if (axes.positions.size() == 3)
    text = "where " + lidar + " is from " + body;
  else if (!axes.positions.empty())
    text = "how far " + lidar + " is from " + body + " along " + ListOf(axes.positions);
  if (axes.turns.empty()) return text;
  if (!text.empty()) text += ", and ";
  return text + "how " + lidar + " is turned on " + body +
         (axes.turns.size() == 3 ? "" : " about " + ListOf(axes.turns));
}

}  // namespace

Diagnosis TooFewPlaced(const TrackerLidarProblem& problem, std::size_t both) {
  return {"too_few_captures",
          Worded("{} has a pose and {} sees {} in only {} from different places; at least {} are needed.",
                 {problem.tracker.id, problem.lidar.id, BoardsOf(problem), CountText(both), kTrackerLidarMin}),
          kTakeMore};
}

Diagnosis FewPlaced(const TrackerLidarProblem& problem, std::size_t used) {
  return {"few_captures",
          Worded("{} have a pose and a board each in only {}; with fewer than {}{}",
                 {PairOf(problem), CountText(used), kTrackerLidarEnough, FewMeanText(used, kTrackerLidarForJackknife)}),
          kTakeMore};
}

Diagnosis NoStaticBoard(const TrackerLidarProblem& problem, std::size_t both, std::size_t supporters) {
  return {"no_agreement",
          Worded("no pose of {} on {} makes {} stand still in more than {} of {}.",
                 {problem.lidar.id, problem.tracker.id, BoardsOf(problem), supporters, CountText(both)}),
          "Leave the boards where they are for the whole session; check plate_size_m, and that clouds and rows of one "
          "name are of one instant."};
}

Diagnosis AmbiguousPlaces(const TrackerLidarProblem& problem) {
  return {"ambiguous_board",
          Worded("two different poses of {} on {} make boards stand still almost equally well.",
                 {problem.lidar.id, problem.tracker.id}),
          "Give nominal poses of both sensors in session.yaml, or turn and move the robot more."};
}

Diagnosis NothingTold(const TrackerLidarProblem& problem) {
  return {"no_motion",
          Worded("{} did not move between the captures in a way that tells anything of {} beyond the noise.",
                 {problem.tracker.id, problem.lidar.id}),
          "Move and turn the robot between captures."};
}

Diagnosis PlacedContradict(const TrackerLidarProblem& problem, const std::vector<CaptureId>& captures) {
  return {"inconsistent_captures",
          Worded("{}: the boards of {} are not where the others have them; they are not used: {}.",
                 {PairOf(problem), CountText(captures.size()), NamesOf(captures)}),
          "Check that the boards did not move, and that clouds and rows of one name are of one instant."};
}

Diagnosis HighPlaneResidual(const TrackerLidarProblem& problem, const TrackerLidarEstimate& estimate) {
  return {"high_residual",
          Worded("{}: the boards' planes are apart between captures by {} and {} rms.",
                 {PairOf(problem), MillimetresText(estimate.rms_m), DegreesText(estimate.rms_rad)}),
          "Check that the boards stood still and are flat, and that the tracker's markers sit tight."};
}

Diagnosis TrackerLidarNotSolvable(const TrackerLidarProblem& problem, const Error& error) {
  return AsDiagnosis(PairOf(problem), "ill_conditioned", error);
}

std::vector<Diagnosis> OpenDirections(const TrackerLidarProblem& problem, const TrackerLidarEstimate& estimate) {
  const auto open = static_cast<std::size_t>(estimate.reach.open.cols());
  if (open == 0) return {};
  const std::string body = problem.tracker.id.str();
  const std::string unknown =
      OpenText(problem.lidar.id.str(), body, AxesOf(estimate.reach, estimate.T_body_lidar)) + " is not known.";
  const MotionWords words = WordsOf(estimate.motion, AxisText(estimate.motion.axis_a));
  if (!words.code.empty() && open <= words.open)
    return {{words.code, Worded("{} was {}: {}", {body, words.moved, unknown}), words.cure}};
  return {{"few_planes",
           Worded("{}{}the {} that {} sees face too much one way for it: {}",
                  {body, words.code.empty() ? ": beside how it moved, " : " was " + words.moved + ", and ",
                   CountText(estimate.boards.size(), "board"), problem.lidar.id, unknown}),
           "Put up boards that face different ways, two and more in view. " + words.cure}};
}

std::vector<Diagnosis> MissedClouds(const TrackerLidarProblem& problem) {
  MissedCaptures unreadable, without;
  std::string first;
  for (const TrackerLidarCapture& capture : problem.captures) {
    if (capture.clouds.empty() || !PatchesOf(capture).empty()) continue;
    const CloudView& cloud = capture.clouds.front();
    if (first.empty()) first = FirstReason(cloud.why_not);
    (cloud.points == 0 ? unreadable : without).Add(capture.capture, "");
  }
  std::vector<Diagnosis> diagnoses;
  if (!unreadable.captures.empty()) diagnoses.push_back(CloudsUnreadable(problem.lidar.id, unreadable));
  if (!without.captures.empty())
    diagnoses.push_back({"board_not_found_in_cloud",
                         Worded("{} does not show {} in {}: {}.{}",
                                {problem.lidar.id, BoardsOf(problem), CountText(without.captures.size()),
                                 NamesOf(without.captures), first}),
                         "Put boards up free of walls and furniture, near enough for several beams to cross them, and "
                         "check plate_size_m in session.yaml."});
  return diagnoses;
}

}  // namespace rigcal::calib
