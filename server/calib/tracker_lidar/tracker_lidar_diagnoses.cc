#include "server/calib/tracker_lidar/tracker_lidar_diagnoses.h"

#include <cmath>
#include <cstdio>

#include "server/calib/core/diagnoses.h"
#include "server/calib/lidar_camera/lidar_camera_diagnoses.h"
#include "server/calib/tracker_lidar/tracker_lidar_work.h"

namespace rigcal::calib {
namespace {

constexpr const char* kTakeMore =
    "Take 20 to 40 captures from different places, turned differently, with boards that stand still in the lidar's "
    "view.";

std::string PairOf(const TrackerLidarProblem& problem) {
  return problem.tracker.id.str() + " and " + problem.lidar.id.str();
}

std::string CountText(std::size_t count) { return std::to_string(count) + (count == 1 ? " capture" : " captures"); }

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
    char number[16];
    std::snprintf(number, sizeof number, "%.3f", value == 0 ? 0.0 : value);
    text += (i == 0 ? "(" : ", ") + std::string(number);
  }
  return text + ")";
}

std::string AnglesText(const MotionReach& motion) {
  char text[64];
  std::snprintf(text, sizeof text, "to within %.2f deg (noise %.2f deg)", motion.tilt_rad * 180 / M_PI,
                motion.tilt_noise_rad * 180 / M_PI);
  return text;
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

std::size_t OpenByMotion(MotionKind kind) {
  switch (kind) {
    case MotionKind::kOneAxis:
      return 1;
    case MotionKind::kOnTheSpot:
      return 2;
    case MotionKind::kNoRotation:
      return 3;
    case MotionKind::kOneLine:
      return 4;
    case MotionKind::kGeneral:
    case MotionKind::kStill:
      break;
  }
  return 0;
}

// What the body did, and the code of it; empty: everything that a body can do.
std::pair<std::string, std::string> MotionWords(const MotionReach& motion) {
  const std::string axis = AxisText(motion.axis_a);
  switch (motion.kind) {
    case MotionKind::kOneAxis:
      return {"planar_motion", "was turned about one axis only, " + axis + ", " + AnglesText(motion)};
    case MotionKind::kOnTheSpot:
      return {"turning_on_the_spot", "was turned about one fixed line only, along " + axis + ", " + AnglesText(motion)};
    case MotionKind::kNoRotation:
      return {"pure_translation", "was moved but not turned"};
    case MotionKind::kOneLine:
      return {"straight_line", "was moved along one line only, " + axis + ", and not turned"};
    case MotionKind::kGeneral:
    case MotionKind::kStill:
      break;
  }
  return {};
}

}  // namespace

Diagnosis TooFewPlaced(const TrackerLidarProblem& problem, std::size_t both) {
  return {"too_few_captures",
          problem.tracker.id.str() + " has a pose and " + problem.lidar.id.str() + " sees " + BoardsOf(problem) +
              " in only " + CountText(both) + " from different places; at least " + std::to_string(kTrackerLidarMin) +
              " are needed.",
          kTakeMore};
}

Diagnosis FewPlaced(const TrackerLidarProblem& problem, std::size_t used) {
  return {
      "few_captures",
      PairOf(problem) + " have a pose and a board each in only " + CountText(used) + "; with fewer than " +
          std::to_string(kTrackerLidarEnough) +
          (used < kTrackerLidarForJackknife ? " the uncertainty comes from the model alone and is probably too small."
                                            : " the uncertainty is itself uncertain."),
      kTakeMore};
}

Diagnosis NoStaticBoard(const TrackerLidarProblem& problem, std::size_t both, std::size_t supporters) {
  return {"no_agreement",
          "no pose of " + problem.lidar.id.str() + " on " + problem.tracker.id.str() + " makes " + BoardsOf(problem) +
              " stand still in more than " + std::to_string(supporters) + " of " + CountText(both) + ".",
          "Leave the boards where they are for the whole session; check plate_size_m, and that clouds and rows of one "
          "name are of one instant."};
}

Diagnosis AmbiguousPlaces(const TrackerLidarProblem& problem) {
  return {"ambiguous_board",
          "two different poses of " + problem.lidar.id.str() + " on " + problem.tracker.id.str() +
              " make boards stand still almost equally well.",
          "Give nominal poses of both sensors in session.yaml, or turn and move the robot more."};
}

Diagnosis NothingTold(const TrackerLidarProblem& problem) {
  return {"no_motion",
          problem.tracker.id.str() + " did not move between the captures in a way that tells anything of " +
              problem.lidar.id.str() + " beyond the noise.",
          "Move and turn the robot between captures."};
}

Diagnosis PlacedContradict(const TrackerLidarProblem& problem, const std::vector<CaptureId>& captures) {
  return {"inconsistent_captures",
          PairOf(problem) + ": the boards of " + CountText(captures.size()) +
              " are not where the others have them; they are not used: " + NamesOf(captures) + ".",
          "Check that the boards did not move, and that clouds and rows of one name are of one instant."};
}

Diagnosis HighPlaneResidual(const TrackerLidarProblem& problem, const TrackerLidarEstimate& estimate) {
  return {"high_residual",
          PairOf(problem) + ": the boards' planes are apart between captures by " + MillimetresText(estimate.rms_m) +
              " and " + DegreesText(estimate.rms_rad) + " rms.",
          "Check that the boards stood still and are flat, and that the tracker's markers sit tight."};
}

Diagnosis TrackerLidarNotSolvable(const TrackerLidarProblem& problem, const Error& error) {
  return {"ill_conditioned", PairOf(problem) + ": " + error.what + ".", error.cure};
}

std::vector<Diagnosis> OpenDirections(const TrackerLidarProblem& problem, const TrackerLidarEstimate& estimate) {
  const auto open = static_cast<std::size_t>(estimate.reach.open.cols());
  if (open == 0) return {};
  const std::string body = problem.tracker.id.str();
  const std::string unknown =
      OpenText(problem.lidar.id.str(), body, AxesOf(estimate.reach, estimate.T_body_lidar)) + " is not known.";
  const auto [code, moved] = MotionWords(estimate.motion);
  const std::string cure = estimate.motion.kind == MotionKind::kOnTheSpot
                               ? "Drive the robot to different places between captures. " + std::string(kTurnMore)
                               : std::string(kTurnMore);
  if (!code.empty() && open <= OpenByMotion(estimate.motion.kind))
    return {{code, body + " " + moved + ": " + unknown, cure}};
  const std::string alike = "the " + std::to_string(estimate.boards.size()) +
                            (estimate.boards.size() == 1 ? " board that " : " boards that ") + problem.lidar.id.str() +
                            " sees face too much one way for it";
  return {{"few_planes",
           body + (code.empty() ? ": beside how it moved, " : " " + moved + ", and ") + alike + ": " + unknown,
           "Put up boards that face different ways, two and more in view. " + cure}};
}

std::vector<Diagnosis> MissedClouds(const TrackerLidarProblem& problem) {
  std::vector<CaptureId> unreadable, without;
  std::string first;
  for (const TrackerLidarCapture& capture : problem.captures) {
    if (capture.clouds.empty() || !PatchesOf(capture).empty()) continue;
    const CloudView& cloud = capture.clouds.front();
    if (first.empty())
      first =
          " The first of them: " + cloud.why_not + (cloud.why_not.empty() || cloud.why_not.back() == '.' ? "" : ".");
    (cloud.points == 0 ? unreadable : without).push_back(capture.capture);
  }
  std::vector<Diagnosis> diagnoses;
  if (!unreadable.empty())
    diagnoses.push_back({"cloud_unreadable",
                         std::to_string(unreadable.size()) + (unreadable.size() == 1 ? " cloud of " : " clouds of ") +
                             problem.lidar.id.str() + " cannot be read and take no part: " + NamesOf(unreadable) + ".",
                         "Copy the files again from where they were recorded, or take those captures again."});
  if (!without.empty())
    diagnoses.push_back({"board_not_found_in_cloud",
                         problem.lidar.id.str() + " does not show " + BoardsOf(problem) + " in " +
                             CountText(without.size()) + ": " + NamesOf(without) + "." + first,
                         "Put boards up free of walls and furniture, near enough for several beams to cross them, and "
                         "check plate_size_m in session.yaml."});
  return diagnoses;
}

Diagnosis RangesTakenAsExact(const TrackerLidarProblem& problem) {
  return {"range_taken_as_exact",
          "The ranges of " + problem.lidar.id.str() + " are taken as free of an error that all of them share.",
          "Give range_bias_sigma_m in session.yaml, such as the range accuracy of its data sheet, and it becomes part "
          "of the uncertainty."};
}

}  // namespace rigcal::calib
