#include <cmath>

#include "server/calib/core/wording.h"
#include "server/calib/lidar_lidar/lidar_lidar_work.h"

namespace rigcal::calib {
namespace {

constexpr const char* kMoreStructure =
    "Take captures where both lidars see walls or objects facing three different ways, also across the direction "
    "named, a few metres away.";

std::string PairOf(const LidarLidarProblem& problem) {
  return problem.lidar_a.id.str() + " and " + problem.lidar_b.id.str();
}

std::string Percent(double ratio) { return Formatted("%.0f %%", 100 * ratio); }

// "shifts along (0.99, 0.10, 0.02)" in b's axes, or "turns about ...": whichever part of the direction is larger.
std::string DirectionText(const Vector6d& direction) {
  const bool shift = direction.head<3>().norm() >= direction.tail<3>().norm();
  Eigen::Vector3d axis = shift ? direction.head<3>() : direction.tail<3>();
  axis.normalize();
  return (shift ? "shifts along " : "turns about ") + LineText(axis);
}

}  // namespace

Diagnosis NoNominalPose(const LidarLidarProblem& problem) {
  return {"no_nominal_pose",
          PairOf(problem) + " have no nominal pose, and two clouds cannot be matched without a rough start.",
          "Give T_ref_nominal of both lidars in session.yaml, right to about 10 degrees and half a metre: a drawing or "
          "a tape measure will do."};
}

Diagnosis NoCommonClouds(const LidarLidarProblem& problem) {
  std::string first;
  for (const LidarLidarCapture& capture : problem.captures)
    if (first.empty() && !capture.why_not.empty()) first = " The first reason: " + capture.why_not;
  if (!first.empty() && first.back() != '.') first += ".";
  return {
      "no_common_clouds",
      Worded("{} have no capture in which both clouds hold {} points.{}", {PairOf(problem), kCloudPointsMin, first}),
      "Record both lidars at the same moments, and name the files of one moment alike."};
}

Diagnosis LowOverlap(const LidarLidarProblem& problem, double overlap_ratio, std::size_t pairs) {
  return {"low_overlap",
          Worded("{} hardly see the same surroundings: {} of one cloud lie where the other one has points, and {} flat "
                 "places are seen by both.",
                 {PairOf(problem), Percent(overlap_ratio), pairs}),
          "Check the nominal poses in session.yaml; take captures where walls or objects stand in the view of both."};
}

Diagnosis PoorFit(const LidarLidarProblem& problem, double match_ratio) {
  return {"poor_fit",
          Worded("{}: only {} of the places that both see agree at the best pose found, so it is most likely the wrong "
                 "one.",
                 {PairOf(problem), Percent(match_ratio)}),
          "Check the nominal poses in session.yaml (10 degrees and half a metre are enough), that the files of one "
          "capture were recorded at the same moment, and that the robot stood still."};
}

Diagnosis StartsDisagree(const LidarLidarProblem& problem, double other_m, double other_rad) {
  return {"ambiguous_pose",
          Worded("{} fit almost equally well at two poses that differ by {} and {}.",
                 {PairOf(problem), Formatted("%.2f m", other_m), DegreesText(other_rad)}),
          "Take captures in a place that does not repeat itself, and give a better nominal pose."};
}

Diagnosis StartsScatter(const LidarLidarProblem& problem, double agreeing_ratio) {
  return {"starts_disagree",
          Worded("{}: only {} of the searches that started about the nominal pose ended at the best pose found.",
                 {PairOf(problem), Percent(agreeing_ratio)}),
          "Give a better nominal pose, and take captures where both see walls or objects facing three different ways."};
}

Diagnosis NotConverged(const LidarLidarProblem& problem, double last_step) {
  return {"not_converged",
          Worded("{}: the pose still moved by {} (m, rad) in its last step.",
                 {PairOf(problem), Formatted("%.1e", last_step)}),
          (problem.polish ? "Leave lidar_polish away in session.yaml: NDT's own pose may have settled. " : "") +
              std::string(kMoreStructure)};
}

Diagnosis NoStructure(const LidarLidarProblem& problem) {
  return {"no_structure", PairOf(problem) + " see nothing flat together that would fix any direction of their pose.",
          kMoreStructure};
}

Diagnosis LidarLidarError(const LidarLidarProblem& problem, const Error& error) {
  return {NameOf(error.code), PairOf(problem) + ": " + error.what, error.cure};
}

Diagnosis DirectionsUnknown(const LidarLidarProblem& problem, const Directions& unknown) {
  std::string list;
  for (Eigen::Index i = 0; i < unknown.cols(); ++i)
    list += (i == 0 ? "" : i + 1 == unknown.cols() ? " and " : ", ") + DirectionText(unknown.col(i));
  return {"unknown_directions",
          Worded("{}: the surroundings do not change when {} {} (its own axes), as in a corridor; there the nominal "
                 "pose was kept, and nothing is claimed.",
                 {PairOf(problem), problem.lidar_b.id, list}),
          kMoreStructure};
}

Diagnosis SingleCapture(const LidarLidarProblem& problem) {
  return {"single_capture",
          PairOf(problem) +
              " have one capture together: sigma is the model's, and the checks are on halves of its "
              "points, each with the pose from the other half.",
          "Take 8 or more captures in different places."};
}

Diagnosis FewClouds(const LidarLidarProblem& problem, std::size_t used) {
  return {"few_captures",
          Worded("{} have only {} together; the uncertainty itself is rough.", {PairOf(problem), CountText(used)}),
          "Take 8 or more captures in different places."};
}

Diagnosis CloudsLeftOut(const LidarLidarProblem& problem, const std::vector<CaptureId>& captures) {
  return {
      "captures_left_out",
      Worded("{}: {} without two usable clouds: {}.", {PairOf(problem), CountText(captures.size()), NamesOf(captures)}),
      "Record both lidars in every capture."};
}

Diagnosis PolishedPose(const LidarLidarProblem& problem, const Vector6d& moved) {
  return {"polished",
          Worded("{}: the pose is not NDT's but polished from there by generalised ICP (GICP), as the session asks "
                 "for; that moved it by {} and {}.",
                 {PairOf(problem), Formatted("%.1f mm", 1e3 * moved.head<3>().norm()),
                  Formatted("%.3f deg", moved.tail<3>().norm() * 180 / M_PI)}),
          "Leave lidar_polish away in session.yaml for NDT's own pose."};
}

Diagnosis RangesTakenAsExact(const LidarLidarProblem& problem) {
  return {"range_taken_as_exact",
          PairOf(problem) +
              ": for at least one of them no range_bias_sigma_m is given, so its ranges are taken to be "
              "right on average.",
          "Give range_bias_sigma_m of both lidars in session.yaml: 0.02 is usual."};
}

}  // namespace rigcal::calib
