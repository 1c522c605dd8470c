// Edges with their whole uncertainty, append-only, and the batches in which finished edges were pushed.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "server/model/edge.h"
#include "storage/store.h"

namespace rigcal::storage {

// Appends edge, uncertainty, block vectors, diagnoses, figures, captures, evidence. A no-op if the id exists. Its robot
// becomes known; its session, if it names one, must be stored. Refuses what is not finite. Of a failed edge pose and
// uncertainty are not kept. All numbers come back bit for bit, but SQLite gives -0.0 in pose and blocks back as 0.0.
[[nodiscard]] Status AppendEdge(Store& store, const Edge& edge, Stamp now);
[[nodiscard]] Result<std::optional<Edge>> LoadEdge(Store& store, const EdgeId& id);
// All edges of a robot, good and failed, sorted by id. With `blocks` false the block vectors are left out.
[[nodiscard]] Result<std::vector<Edge>> LoadEdges(Store& store, const RobotId& robot, bool blocks);
// Sorted by id; only those of the session.
[[nodiscard]] Result<std::vector<Edge>> LoadEdges(Store& store, const SessionId& session);
// When each edge of the robot was measured: its session was captured or, of one that was pushed, it was stored.
[[nodiscard]] Result<std::map<EdgeId, Stamp>> LoadMeasuredAt(Store& store, const RobotId& robot);
// How many edges of the robot have a row number up to `watermark`.
[[nodiscard]] Result<std::int64_t> CountEdges(Store& store, const RobotId& robot, std::int64_t watermark);
// Row number of the newest edge of the robot; 0 if none. It only grows.
[[nodiscard]] Result<std::int64_t> LoadEdgeWatermark(Store& store, const RobotId& robot);

// A batch of finished edges: item i was edge id. Both are no-ops for what exists; kConflict if it exists otherwise
// (another count, another edge). Append the edge first. Call AppendBatch in every Write that appends items: `now` is
// their stamp.
[[nodiscard]] Status AppendBatch(Store& store, const RobotId& robot, const BatchId& batch, std::int64_t count,
                                 Stamp now);
[[nodiscard]] Status AppendBatchItem(Store& store, const BatchId& batch, std::int64_t item_idx, const EdgeId& edge);
// held[i]: item i is durable; nullopt if the batch is unknown.
[[nodiscard]] Result<std::optional<std::vector<bool>>> LoadBatchHeld(Store& store, const BatchId& batch);
// Stamp of the newest item of an incomplete batch of the robot (of the batch, if it has none); nullopt if all batches
// are complete.
[[nodiscard]] Result<std::optional<Stamp>> LoadOpenBatch(Store& store, const RobotId& robot);

}  // namespace rigcal::storage
