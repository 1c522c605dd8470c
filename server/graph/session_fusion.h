// The least-squares problem over poses that sessions' joint refinements and pushed edges make (fuse_sessions.h has the
// model): as a value, and its optimum.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "server/graph/visit_scatter.h"
#include "server/model/graph.h"
#include "server/model/session_estimate.h"

namespace rigcal::graph {

constexpr int kFixed = -1;  // the robot's reference

// What counts of one session's refinement: poses in the frame of its reference.
struct SessionFactor {
  int frame = kFixed;         // variable: the reference's pose, or a free one
  std::vector<int> variable;  // of each pose
  std::vector<Se3> T_frame_sensor;
  std::vector<double> dof;
  Eigen::MatrixXd C, common;  // joint covariance; the part of it that is alike on every visit (may be empty)
};
struct EdgeFactor {
  int a = kFixed, b = kFixed;
  Se3 T_a_b;
  Matrix6d Omega = Matrix6d::Zero();
};

struct SessionFusion {
  std::vector<SensorId> sensors;       // of the first variables; behind them are free frames of sessions
  std::vector<Se3> T_ref;              // per variable
  std::vector<SessionFactor> factors;
  std::vector<SessionId> sessions;     // of the factors
  std::vector<EdgeFactor> edges;
  std::vector<VisitVariance> scatter;  // per sensor

  [[nodiscard]] Eigen::Index Size() const { return 6 * static_cast<Eigen::Index>(T_ref.size()); }
  [[nodiscard]] Se3 Pose(int variable) const {
    return variable == kFixed ? Se3{} : T_ref[static_cast<std::size_t>(variable)];
  }
};

struct FusionInput {
  const std::vector<Edge>& edges;  // as they stand: they say what of a session counts
  const SensorId& reference;
  const GraphSolution& start;      // its known poses
};
using SensorsOfSessions = std::set<std::pair<SessionId, SensorId>>;
// A session with an estimate none of whose edges was retired: that is in the estimate all the same.
[[nodiscard]] bool IsFused(const SessionEstimate& estimate, const std::vector<Edge>& edges);
// Of the sessions of `estimates` that are fused, without `left_out`; `with_edges`: pushed edges, and those of sessions one
// of whose sensors is in no estimate.
[[nodiscard]] SessionFusion FusionOf(const FusionInput& input, const std::vector<SessionEstimate>& estimates,
                                     bool with_edges, const SensorsOfSessions& left_out = {});

struct LinearFactor {
  Eigen::VectorXd e;
  Eigen::MatrixXd J, W;  // by all variables; information, scatter between visits included
};
[[nodiscard]] LinearFactor Linearized(const SessionFusion& fusion, const SessionFactor& factor);

// Moves the poses to the optimum with the scatter held; H^-1. Nothing where something is left open.
[[nodiscard]] std::optional<Eigen::MatrixXd> Settle(SessionFusion& fusion);
// Per sensor, what each visit says of it beside the whole.
[[nodiscard]] std::vector<std::vector<VisitResidual>> ResidualsOfVisits(const SessionFusion& fusion);

}  // namespace rigcal::graph
