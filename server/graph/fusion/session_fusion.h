// The poses of a numbered revision: what the joint refinements of the robot's sessions say, fused with edges that no
// raw data stand behind. The graph of pairs stays beside it, as the paper has it: start, check and fallback.
//
// A session is one factor over the sensors that it still says something of: their poses T_k,s in the frame X_k of its
// reference, e_s = Log(T_k,s^-1 X_k^-1 T_ref,s) for all of them together with their joint covariance. Where its own
// reference does not count any more (it was remounted since), X_k is free, and what is left are the poses among the
// rest. Pushed edges are factors by their Omega. An edge of a session counts where one of its sensors is in no
// refinement.
//
// From visit to visit a sensor sits a little elsewhere: T_k,s = T_s Exp(b), b ~ N(0, diag(v_t^2 I, v_r^2 I)) per sensor
// (BetweenVisits), held against what visits of other robots of the rig model scatter by (visit_scatter.h) where that is
// known, then with axes as unlike as theirs; where it is not, each axis goes by itself (TakenScatter). T_s itself goes
// from visit to visit, too, and does not come back (WalkOf): the pose told is that on the newest visit. The
// covariance told is that of the place on the next one, the pose's, v^2 and the walk until then: a robot is used
// between visits. What errs alike on every visit (SessionEstimate::common) does not fall with their number.
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "server/model/graph/graph.h"
#include "server/model/graph/visit_scatter.h"
#include "server/model/sessions/session_estimate.h"

namespace rigcal::graph {

// Puts fused poses, covariances and degrees of freedom into the known poses of `solution`, those of the graph beside
// them (SensorPose::fused). `edges` as they stand, and `within` those of sessions that are in merged edges among them.
// Without a session that was refined and of which no edge was retired, nothing changes. At most kFusedSensorsMax known
// sensors. `pooled`: what other robots of the rig model scatter by; what the robot's own visits tell
// (FusedPose::scatter) is the same with it and without. `dates`: when it was measured; nothing walks over days that are
// not told.
struct VisitDates {
  std::map<SessionId, Stamp> sessions;
  std::map<EdgeId, Stamp> edges;
};
void FuseSessions(const std::vector<Edge>& edges, const std::vector<Edge>& within, const SensorId& reference,
                  const std::vector<SessionEstimate>& estimates, GraphSolution& solution,
                  const PooledScatter& pooled = {}, const VisitDates& dates = {});
constexpr std::size_t kFusedSensorsMax = 200;

// The least-squares problem over poses that sessions' joint refinements and pushed edges make: as a value, and its
// optimum.
// How much a sensor's place scatters from visit to visit beyond what the visits themselves are uncertain by.
// Per axis, squared; by_axis where they are taken as unlike.
struct VisitVariance {
  double translation_m2 = 0.0, rotation_rad2 = 0.0;
  std::optional<Vector6d> by_axis = std::nullopt;
  // As a covariance of a pose: diagonal, translation first.
  [[nodiscard]] Matrix6d Matrix() const;
  bool operator==(const VisitVariance&) const = default;
};

// What a visit said of the sensor, less where the sensor is on the whole.
struct VisitResidual {
  Vector6d e;    // right tangent at the sensor
  Matrix6d own;  // covariance of what the visit errs by and others do not: no residual between visits has the rest
  double age_days = 0.0;  // before the newest visit
};

// How many places the residuals of shifts and of turns are less of: one where a sensor stays, more where it walks.
struct MeansTaken {
  double translation = 1.0, rotation = 1.0;
};

// The variance at which sum e^T (own + v I)^-1 e over the visits is as expected, 3 (visits - means), for translation
// and for rotation apart (Paule & Mandel 1982). Zero where the visits agree within their own sigmas, and where there
// are not more of them than means.
[[nodiscard]] VisitVariance BetweenVisits(const std::vector<VisitResidual>& visits, const MeansTaken& means = {});
// How many of three axes (`part`: tangent::kTranslation or kRotation), of any direction, take part in a scatter of
// `variance`, 1 to 3: 3 / c of c = 3 tr S^2 / (tr S)^2, S the scatter over what is expected of it, 1 where all scatter
// alike and 3 where one does alone, less what chance makes of three alike in n = visits - means: 3 (n + 4) / (3 n + 2),
// of a Wishart distribution.
[[nodiscard]] double AxesThatScatter(const std::vector<VisitResidual>& visits, int part, double variance, int means);
// The same not held at zero: where the visits agree better than they say it is below, down to what the surest of their
// axes errs by. With what the visits err by on average, the degrees of freedom, 3 (visits - means) for each group of
// axes, and the ratio of its axes: ratio_a = sum e_a^2 / (own_aa + v) / (visits - means).
[[nodiscard]] VisitScatter ScatterShown(const std::vector<VisitResidual>& visits, const MeansTaken& means = {});

constexpr int kFixed = -1;  // the robot's reference

// What counts of one session's refinement: poses in the frame of its reference.
struct SessionFactor {
  int frame = kFixed;         // variable: the reference's pose, or a free one
  std::vector<int> variable;  // of each pose
  std::vector<Se3> T_frame_sensor;
  std::vector<double> dof;
  Eigen::MatrixXd C, common;  // joint covariance; the part of it that is alike on every visit (may be empty)
  SessionId session;
  double age_days = 0.0;  // before the newest one (visit_ages.h)
};
struct EdgeFactor {
  int a = kFixed, b = kFixed;
  Se3 T_a_b;
  Matrix6d Omega = Matrix6d::Zero();
  EdgeId edge = {};
  double age_days = 0.0;  // before the newest session; one that is newer: 0
};

struct SessionFusion {
  std::vector<SensorId> sensors;  // of the first variables; behind them are free frames of sessions
  std::vector<Se3> T_ref;         // per variable
  std::vector<SessionFactor> factors;
  std::vector<SessionId> sessions;  // of the factors; one whose islands were refined apart has several
  std::vector<EdgeFactor> edges;
  std::vector<VisitVariance> scatter;  // per sensor
  std::vector<VisitVariance> walk;     // per sensor, in a day

  // Scalars that are sought: six for each variable.
  [[nodiscard]] Eigen::Index Size() const { return 6 * static_cast<Eigen::Index>(T_ref.size()); }
  // In the reference; kFixed is the reference itself.
  [[nodiscard]] Se3 Pose(int variable) const {
    return variable == kFixed ? Se3{} : T_ref[static_cast<std::size_t>(variable)];
  }
};

struct FusionInput {
  const std::vector<Edge>& edges;   // as they stand: they say what of a session counts
  const std::vector<Edge>& within;  // likewise, of sessions that are in merged edges: ends, state and diagnoses
  const SensorId& reference;
  const GraphSolution& start;  // its known poses
};
using SensorsOfSessions = std::set<std::pair<SessionId, SensorId>>;
// A session with an estimate none of whose edges was retired: that is in the estimate all the same.
[[nodiscard]] bool IsFused(const SessionEstimate& estimate, const FusionInput& input);
// Of the sessions of `estimates` that are fused, without `left_out`; `with_edges`: pushed edges, and those of sessions
// whose two sensors no estimates tie: one of them is in none, or they are in islands of their own.
[[nodiscard]] SessionFusion FusionOf(const FusionInput& input, const std::vector<SessionEstimate>& estimates,
                                     bool with_edges, const SensorsOfSessions& left_out = {});

struct LinearFactor {
  Eigen::VectorXd e;
  Eigen::MatrixXd J, W;  // by all variables; information, scatter between visits included
};
// What a session's poses scatter by about where the sensors are then: its own covariance and the scatter between
// visits.
[[nodiscard]] Eigen::MatrixXd WithScatter(const SessionFusion& fusion, const SessionFactor& factor);
// At the poses at hand: six rows for each sensor of the factor. W is zero where the covariance cannot be inverted.
[[nodiscard]] LinearFactor Linearized(const SessionFusion& fusion, const SessionFactor& factor);

// Moves the poses to the optimum with scatter and walk held; H^-1. Nothing where something is left open. Where a sensor
// walks, the pose is that on the newest visit: sessions and edges are taken the oldest first, and over the days between
// two of them what all before know becomes (H^-1 + Q)^-1, Q the walk (an information filter).
[[nodiscard]] std::optional<Eigen::MatrixXd> Settle(SessionFusion& fusion);
// What `inverse`, of the optimum, is made of.
struct Gains {
  // What an error of each session moves the poses by: variables by its six rows for each sensor.
  std::vector<Eigen::MatrixXd> of_sessions;
  Eigen::MatrixXd by_walk;  // covariance of what is not known for the walk
};
[[nodiscard]] Gains GainsOf(const SessionFusion& fusion, const Eigen::MatrixXd& inverse);
// Per sensor, what each visit says of it beside the whole.
[[nodiscard]] std::vector<std::vector<VisitResidual>> ResidualsOfVisits(const SessionFusion& fusion);

// Was a sensor moved between two visits? Each change between two sessions that follow each other is asked about, of all
// sessions that are fused: what was found is found until it is settled or nothing from before it is fused. For each
// sensor s, the reference too, and each change: what the sessions after it say against those before, d_s =
// Log(T_before,s^-1 T_after,s) of all sensors that both tell, with the covariance S of both sides and the scatter that
// visits have within the sides. The sides are the kVisitsCompared sessions nearest to the change that tell of the
// sensor, half of them on each where there are as many: a change is held against the scatter about it, in
// which neither another one is nor what a mount crept by in years, and the cost grows with the sessions as a line does.
// The step that explains it best, its gain d^T S^-1 E m over six numbers, is an F where the scatter was
// estimated, of as many numbers and degrees of freedom as axes take part in it (AxesThatScatter, the fewest of any
// sensor); odds are corrected for all looks, sensors times changes. Two visits tell no scatter, few hardly, and no such
// F is unlikely: where the two sessions nearest to the change tell it by themselves, it stands unless a scatter
// explains it that a sound mount has (0.75 mm and 0.75 mrad along each axis), or that the visits show. What was found
// is taken out of the sessions before, and the next is looked for. Where one side does not tell the reference, as it
// was remounted since, the rest is held against the sensor that both sides tell the oftenest. `estimates` newest first.
// Only sessions that are fused take part. What both sides tell apart from the reference, as an island, is asked in the
// frame of one of its sensors.
//
// A sound mount's scatter hides moves that matter: of two visits some 5 mm. `apart` has those: what a session has
// elsewhere than the newest that tells of the sensor, beyond the two's own covariances, less what `moved` explains, of
// the newest kVisitsApart.
// Nobody can tell a move from a mount that scatters. Where all mounts scatter by what a sound one may along every axis,
// a step of `apart` is beyond 5 mm or 5 mrad for a sensor in one or two of a thousand pairs of visits.
struct MovesBetween {
  std::vector<SensorMovedBetween> moved, apart;
};
[[nodiscard]] MovesBetween FindMovesBetween(const FusionInput& input, const std::vector<SessionEstimate>& estimates);

}  // namespace rigcal::graph
