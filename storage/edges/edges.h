// Edges with their whole uncertainty, append-only, and the batches in which finished edges were pushed.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "server/model/edges/edge.h"
#include "storage/store.h"

namespace rigcal::storage {

// An edge counts from when it is appended, one of a batch from when the whole batch is there: all Load... give edges
// that count, and no others.
//
// Appends edge, uncertainty, block vectors, diagnoses, figures, captures, evidence. A no-op if the id exists. Its robot
// becomes known; its session, if it names one, must be stored. Refuses what is not finite. Of a failed edge pose and
// uncertainty are not kept. All numbers come back bit for bit, but SQLite gives -0.0 in pose and blocks back as 0.0.
[[nodiscard]] Status AppendEdge(Store& store, const Edge& edge, Stamp now);
[[nodiscard]] Result<std::optional<Edge>> LoadEdge(Store& store, const EdgeId& id);
// All edges of a robot, good and failed, sorted by id. With `blocks` false the block vectors are left out.
[[nodiscard]] Result<std::vector<Edge>> LoadEdges(Store& store, const RobotId& robot, bool blocks);
enum class EdgeParts { kAll, kRow };
// Those that are in no merged edge (merged_edges.h), sorted by id: whole, or ids, ends, state, pose, uncertainty
// without its block vectors, and overlap_ratio of its figures, which is what a graph is made of.
[[nodiscard]] Result<std::vector<Edge>> LoadUnmergedEdges(Store& store, const RobotId& robot, EdgeParts parts);
// Those of `ids` that are there, sorted by id; likewise.
[[nodiscard]] Result<std::vector<Edge>> LoadEdges(Store& store, const std::vector<EdgeId>& ids, bool blocks = true);
// Ids of the robot's edges, the one that began to count last first, up to `limit`: those after the edge `before`, the
// first ones if it is empty. kNotFound if it is none of the robot's.
[[nodiscard]] Result<std::vector<EdgeId>> LoadEdgeIds(Store& store, const RobotId& robot, const EdgeId& before,
                                                      std::int64_t limit);
// Sorted by id; only those of the session.
[[nodiscard]] Result<std::vector<Edge>> LoadEdges(Store& store, const SessionId& session);
// Those of the sessions, sorted by id: ids, ends, pose, uncertainty, overlap_ratio, and nothing else of them.
[[nodiscard]] Result<std::vector<Edge>> LoadEdgeRows(Store& store, const std::vector<SessionId>& sessions);
// When each of the edges was measured: its session was captured; of one that was pushed, what it says or, where it does
// not, when it was stored.
[[nodiscard]] Result<std::map<EdgeId, Stamp>> LoadMeasuredAt(Store& store, const std::vector<Edge>& edges);
// How many edges of the robot began to count up to `watermark`.
[[nodiscard]] Result<std::int64_t> CountEdges(Store& store, const RobotId& robot, std::int64_t watermark);
// Number of the robot's edge that began to count last; 0 if none. It grows whenever one begins to count.
[[nodiscard]] Result<std::int64_t> LoadEdgeWatermark(Store& store, const RobotId& robot);

// A batch of finished edges: item i is that edge. Both are no-ops for what exists; kConflict if it exists otherwise
// (another count, another edge). Call AppendBatch in every Write that appends items. With the last item that was
// missing all edges of the batch begin to count, in that transaction.
[[nodiscard]] Status AppendBatch(Store& store, const RobotId& robot, const BatchId& batch, std::int64_t count,
                                 Stamp now);
struct BatchEdge {
  std::int64_t idx;  // of the item
  const Edge& edge;
};
[[nodiscard]] Status AppendBatchItems(Store& store, const BatchId& batch, const std::vector<BatchEdge>& items,
                                      Stamp now);
// held[i]: item i is durable; nullopt if the batch is unknown.
[[nodiscard]] Result<std::optional<std::vector<bool>>> LoadBatchHeld(Store& store, const BatchId& batch);
struct OpenBatch {
  BatchId id;
  RobotId robot;
  std::int64_t items = 0, held = 0;
  Stamp opened_at, newest_at;  // `newest_at`: when an item was last pushed
};
// Batches of which items are missing, of one robot, or of all if `robot` is empty; the oldest first. Their edges do not
// count.
[[nodiscard]] Result<std::vector<OpenBatch>> LoadOpenBatches(Store& store, const RobotId& robot);

}  // namespace rigcal::storage
