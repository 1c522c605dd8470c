// Judges a robot's revision: verdict with one plain sentence why and one what to do.
//
// Severity, worst first, and what decides: fail (an edge contradicts the others, or two sensors are exchanged and a
// third bears it out), unknown (a sensor without a pose, one whose pose a cause makes wrong or that is less certain
// than the policy wants, or no settled solution), warn (failed edges, a sensor far from nominal, nothing that checks
// the result), pass. The worst that applies is the verdict; of several reasons of one level all are named, causes
// first: failures that have one in common (root_causes.h) are told by it alone. What contradicts fails where it is both
// more than chance and more than the policy's least move; less than that is told, and more than its tolerance warns
// even where it may be chance (effect.h).
#pragma once

#include <map>
#include <set>
#include <vector>

#include "server/base/stamp.h"
#include "server/model/approval/policy.h"
#include "server/model/graph/graph.h"
#include "server/model/graph/joint_poses.h"
#include "server/model/graph/other_paths.h"
#include "server/model/robots/rig_model.h"
#include "server/model/sessions/session.h"
#include "server/model/sessions/session_estimate.h"
#include "server/model/verdict_basis.h"

namespace rigcal::fleet {

// Uses T^2 limits where a covariance was estimated from blocks, chi-square where it is known. No loop in the graph
// means that nothing checks the result: warn. Edges in loops that nothing checks (see UncheckedEdges), or that cannot
// be tested: warn, by name. "The edges agree" is said only where loops, or the cost, were tested, and no pair of a
// refined session is beyond the policy's limits either. Unknown sensors (those that occur only in failed edges too):
// unknown, by name. Failed edges: warn, by name, unless the same two sensors have a good edge as well (the failure was
// repaired since). Sessions are named by when they were captured, as far as that is known.
using SessionTimes = std::map<SessionId, Stamp>;
// `estimates`: of the sessions that count, the newest first; a sensor that was moved during one of them fails the
// robot, and is told before what it made of the edges. A lens that bends beyond its model warns, by name; where nothing
// else than such lenses of one session can be behind edges that disagree, no edge or sensor is accused. `headers`: of
// the sessions of the edges, as far as they are known: what they say of boards and of nominal poses.
using SessionHeaders = std::map<SessionId, SessionHeader>;
// `edges`: all of the robot; `solution`: of them. `between`: how well those pairs that the policy names are known, and
// what else is known of what each edge measures, by the same solution, as far as they are. `expected`: what the robot's
// rig model says of it, which warns; of sensors that are `retired` nobody asks.
struct KnownBetween {
  PairCovariances pairs;
  OtherPaths others;
};
struct Judgement {
  Verdict verdict;
  VerdictBasis basis;
};
[[nodiscard]] Judgement Judge(const std::vector<Edge>& edges, const GraphSolution& solution, const Policy& policy = {},
                              const SessionTimes& captured_at = {}, const std::vector<SessionEstimate>& estimates = {},
                              const SessionHeaders& headers = {}, const KnownBetween& between = {},
                              const ExpectedRig& expected = {}, const std::set<SensorId>& retired = {});
// Its verdict alone.
[[nodiscard]] Verdict Assess(const std::vector<Edge>& edges, const GraphSolution& solution, const Policy& policy = {},
                             const SessionTimes& captured_at = {}, const std::vector<SessionEstimate>& estimates = {},
                             const SessionHeaders& headers = {}, const KnownBetween& between = {},
                             const ExpectedRig& expected = {}, const std::set<SensorId>& retired = {});

// "statistic / limit" of one edge's residual: T^2 by the jackknife covariance of that residual where the solution has
// it, else e^T Omega e (edge covariance minus what the solution explains is not used: conservative). limit is 0 where
// it cannot be judged: the edge takes no part, or its covariance was estimated from too few blocks.
struct EdgeTest {
  double statistic = 0.0;
  double limit = 0.0;
};
// `edge_count`: of the edges that are tested together, which share the odds of a false accusation.
[[nodiscard]] EdgeTest TestResidual(const Edge& edge, const EdgeResidual& residual, std::size_t edge_count,
                                    const Policy& policy = {});

}  // namespace rigcal::fleet
