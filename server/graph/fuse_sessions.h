// The poses of a numbered revision: what the joint refinements of the robot's sessions say, fused with edges that no raw
// data stand behind. The graph of pairs stays beside it, as the paper has it: start, check and fallback.
//
// A session is one factor over the sensors that it still says something of: their poses T_k,s in the frame X_k of its
// reference, e_s = Log(T_k,s^-1 X_k^-1 T_ref,s) for all of them together with their joint covariance. Where its own
// reference does not count any more (it was remounted since), X_k is free, and what is left are the poses among the rest.
// Pushed edges are factors by their Omega. An edge of a session counts where one of its sensors is in no refinement.
//
// From visit to visit a sensor sits a little elsewhere: T_k,s = T_s Exp(b), b ~ N(0, diag(v_t^2 I, v_r^2 I)) per sensor
// (BetweenVisits). The covariance told is that of the place on a visit, the mean's and v^2: a robot is used between
// visits. What errs alike on every visit (SessionEstimate::common) does not fall with their number.
#pragma once

#include <vector>

#include "server/model/graph.h"
#include "server/model/session_estimate.h"

namespace rigcal::graph {

// Puts fused poses, covariances and degrees of freedom into the known poses of `solution`, those of the graph beside them
// (SensorPose::fused). `edges` as they stand. Without a session that was refined and of which no edge was retired, nothing
// changes. At most kFusedSensorsMax known sensors.
void FuseSessions(const std::vector<Edge>& edges, const SensorId& reference,
                  const std::vector<SessionEstimate>& estimates, GraphSolution& solution);
constexpr std::size_t kFusedSensorsMax = 200;

}  // namespace rigcal::graph
