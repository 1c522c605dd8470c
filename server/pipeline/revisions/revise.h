// Once per burst: the canonical solve of all good edges of a robot -> the numbered revision.
#pragma once

#include <set>

#include "server/base/stamp.h"
#include "server/model/graph/graph.h"
#include "server/model/sessions/recomputation.h"
#include "storage/store.h"
#include "storage/work/recomputations.h"

namespace rigcal::pipeline {

// The graph of a robot: good edges, plus the sensors that appear only in failed ones or only in a session's list,
// without those that were retired. What was retired, superseded or remounted since is failed there with that reason
// (current_edges.h) and takes no part. The reference is the one that the earliest captured session names (ties: smaller
// session id), of those that name none which was retired; without such a session, GraphOf's own rule. Edges that were
// merged take part as the edges that stand for them.
struct RobotGraph {
  std::vector<Edge> edges;  // good and failed, sorted by id
  std::set<EdgeId> weak;    // of these, good ones that are not in the graph, as better ones hold both of their sensors
  Graph graph;
  std::int64_t watermark = 0, standing_watermark = 0;
};
// As the live state needs it: `edges` are storage::EdgeParts::kRow.
[[nodiscard]] Result<RobotGraph> LoadRobotGraph(storage::Store& store, const RobotId& robot);

// Merges the older edges of pairs that were pushed often (merged_edge.h), solves, judges and commits. The same edges
// that count give the same document, byte for byte, whatever the order of arrival, but that of edges of one pair beyond
// kEdgesKeptOfPair: the newest stay as they are. Edges that were pushed without a date are of when they came, also for
// what holds a weak pair (weak_edges.h).
// With `pairs_waiting` pairs of the robot's sessions still to be calibrated it is not judged: unknown, and used by
// nobody. `merges_anew`: from all stored edges, where they wait for that; without, the older ones stay merged as they
// are, and wait no more.
[[nodiscard]] Result<Revision> Revise(storage::Store& store, const RobotId& robot, const Clock& clock,
                                      std::int64_t pairs_waiting = 0, bool merges_anew = true);
// The robot of `item` once more, with what that run computed of its sessions. Where the document is that of its newest
// revision, byte for byte, there is no new one; else a candidate that the policy has no say about, and what it would
// change against the calibration in use (none is: against the newest). That the robot is done is noted in the same
// transaction.
[[nodiscard]] Result<RecomputedRobot> ReviseAnew(storage::Store& store, const storage::RecomputationItem& item,
                                                 const Clock& clock);
[[nodiscard]] bool IsJudged(const Revision& revision);

}  // namespace rigcal::pipeline
