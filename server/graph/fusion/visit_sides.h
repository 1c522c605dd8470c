// What the sessions before a change, and those from it on, say against each other.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <set>
#include <vector>

#include "server/graph/fusion/session_fusion.h"

namespace rigcal::graph {

constexpr int kMovesMax = 4;                 // of a robot, or between two sessions
constexpr std::size_t kVisitsCompared = 16;  // of a sensor, about a change
constexpr std::size_t kVisitsApart = 8;      // the newest

// Sessions on one side of a change, fused.
struct Side {
  SessionFusion fusion;
  Eigen::MatrixXd covariance;  // of its poses
};
struct Sides {
  Side before, after;
  int visits = 0;
};

// What both sides say of the sensors that both tell: d_s = Log(T_before,s^-1 T_after,s), m and rad, with covariance S.
struct Difference {
  std::vector<SensorId> sensors;
  std::vector<Se3> T_before;
  Eigen::VectorXd d;
  Eigen::MatrixXd S;
};

// Visits that are fused, the oldest first, and of each the sensors that it tells, the reference too.
struct Visits {
  std::vector<SessionEstimate> sessions;
  std::vector<std::set<SensorId>> told;
};

// Nothing where one side has no session that counts, or they tell no sensor both. `sensors_asked`: of how many it may
// be asked whether it was changed, the reference too.
struct BothSides {
  Sides sides;
  Difference difference;
  double sensors_asked = 0.0;
};
// Visits before the element `first_after`, and from it on, of each side those that hang together with the reference, as
// no edge ties an island to it here; with one scatter per sensor from the residuals within the sides.
[[nodiscard]] std::optional<BothSides> SidesAbout(const FusionInput& input, const Visits& visits,
                                                  std::size_t first_after, const SensorsOfSessions& left_out);
// The same under a scatter that is taken as known: what a sound mount may scatter by, of the reference too, or all that
// a sensor's visits show, as if along one axis and the more so the fewer they are, where that is more.
[[nodiscard]] std::optional<Difference> DifferenceOfSoundMounts(Sides sides);

// Columns: a step of the reference, T_before = X T_after.
[[nodiscard]] Eigen::MatrixXd ByReference(const Difference& difference);

// That one sensor, the reference too, was moved by `step`, right tangent at it.
struct Change {
  SensorId sensor;
  Vector6d step = Vector6d::Zero();
  Matrix6d covariance = Matrix6d::Zero();
  double gain = 0.0;  // that it explains of d^T S^-1 d
};
// Of each sensor by itself, the reference last where there are two others or more.
[[nodiscard]] std::vector<Change> ChangesOf(const Difference& difference, const SensorId& reference);
[[nodiscard]] Change LikeliestChange(const Difference& difference, const SensorId& reference);
// Of so large a gain by chance alone, at most: over six numbers under the scatter that visits have within the sides.
[[nodiscard]] double TailOf(const Sides& sides, double gain);

// Known poses in the frame of one of them.
[[nodiscard]] GraphSolution InFrameOf(const SensorId& frame, const GraphSolution& solution);

// That the session tells in the frame of the robot's reference, this too.
[[nodiscard]] std::set<SensorId> SensorsTold(const FusionInput& input, const SessionEstimate& estimate,
                                             const SensorsOfSessions& left_out);

// `apart` of MovesBetween, less what is left out: of each sensor what older sessions are apart from the newest that
// tells of it.
[[nodiscard]] std::vector<SensorMovedBetween> FindApart(const FusionInput& input,
                                                        const std::vector<SessionEstimate>& oldest_first,
                                                        const SensorsOfSessions& left_out);

}  // namespace rigcal::graph
