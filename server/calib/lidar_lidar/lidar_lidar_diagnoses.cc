#include "server/calib/lidar_lidar/lidar_lidar_diagnoses.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "server/calib/core/diagnoses.h"
#include "server/calib/lidar_lidar/lidar_lidar_work.h"

namespace rigcal::calib {
namespace {

constexpr const char* kMoreStructure =
    "Take captures where both lidars see walls or objects facing three different ways, also across the direction "
    "named, a few metres away.";

std::string PairOf(const LidarLidarProblem& problem) {
  return problem.lidar_a.id.str() + " and " + problem.lidar_b.id.str();
}

std::string Formatted(const char* format, double value) {
  char text[48];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string Percent(double ratio) { return Formatted("%.0f %%", 100 * ratio); }

// "1 capture", "3 captures".
std::string Captures(std::size_t count) { return std::to_string(count) + (count == 1 ? " capture" : " captures"); }

// "shifts along (0.99, 0.10, 0.02)" in b's axes, or "turns about ...": whichever part of the direction is larger.
std::string DirectionText(const Vector6d& direction) {
  const bool shift = direction.head<3>().norm() >= direction.tail<3>().norm();
  Eigen::Vector3d axis = shift ? direction.head<3>() : direction.tail<3>();
  axis.normalize();
  Eigen::Index largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  if (axis[largest] < 0) axis = -axis;
  char text[96];
  std::snprintf(text, sizeof text, "%s (%.2f, %.2f, %.2f)", shift ? "shifts along" : "turns about", axis.x() + 0.0,
                axis.y() + 0.0, axis.z() + 0.0);
  return text;
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
  return {"no_common_clouds",
          PairOf(problem) + " have no capture in which both clouds hold " + std::to_string(kCloudPointsMin) +
              " points." + first,
          "Record both lidars at the same moments, and name the files of one moment alike."};
}

Diagnosis LowOverlap(const LidarLidarProblem& problem, double overlap_ratio, std::size_t pairs) {
  return {"low_overlap",
          PairOf(problem) + " hardly see the same surroundings: " + Percent(overlap_ratio) +
              " of one cloud lie where the other one has points, and " + std::to_string(pairs) +
              " flat places are seen by both.",
          "Check the nominal poses in session.yaml; take captures where walls or objects stand in the view of both."};
}

Diagnosis PoorFit(const LidarLidarProblem& problem, double match_ratio) {
  return {"poor_fit",
          PairOf(problem) + ": only " + Percent(match_ratio) +
              " of the places that both see agree at the best pose found, so it is most likely the wrong one.",
          "Check the nominal poses in session.yaml (10 degrees and half a metre are enough), that the files of one "
          "capture were recorded at the same moment, and that the robot stood still."};
}

Diagnosis StartsDisagree(const LidarLidarProblem& problem, double other_m, double other_rad) {
  return {"ambiguous_pose",
          PairOf(problem) + " fit almost equally well at two poses that differ by " + Formatted("%.2f m", other_m) +
              " and " + Formatted("%.1f deg", other_rad * 180 / M_PI) + ".",
          "Take captures in a place that does not repeat itself, and give a better nominal pose."};
}

Diagnosis StartsScatter(const LidarLidarProblem& problem, double agreeing_ratio) {
  return {"starts_disagree",
          PairOf(problem) + ": only " + Percent(agreeing_ratio) +
              " of the searches that started about the nominal pose ended at the best pose found.",
          "Give a better nominal pose, and take captures where both see walls or objects facing three different ways."};
}

Diagnosis NotConverged(const LidarLidarProblem& problem, double last_step) {
  return {"not_converged",
          PairOf(problem) + ": the pose still moved by " + Formatted("%.1e", last_step) + " (m, rad) in its last step.",
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
          PairOf(problem) + ": the surroundings do not change when " + problem.lidar_b.id.str() + " " + list +
              " (its own axes), as in a corridor; there the nominal pose was kept, and nothing is claimed.",
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
          PairOf(problem) + " have only " + Captures(used) + " together; the uncertainty itself is rough.",
          "Take 8 or more captures in different places."};
}

Diagnosis CloudsLeftOut(const LidarLidarProblem& problem, const std::vector<CaptureId>& captures) {
  return {"captures_left_out",
          PairOf(problem) + ": " + Captures(captures.size()) + " without two usable clouds: " + NamesOf(captures) + ".",
          "Record both lidars in every capture."};
}

Diagnosis PolishedPose(const LidarLidarProblem& problem, const Vector6d& moved) {
  return {
      "polished",
      PairOf(problem) +
          ": the pose is not NDT's but polished from there by generalised ICP (GICP), as the session asks for; that "
          "moved it by " +
          Formatted("%.1f mm", 1e3 * moved.head<3>().norm()) + " and " +
          Formatted("%.3f deg", moved.tail<3>().norm() * 180 / M_PI) + ".",
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
