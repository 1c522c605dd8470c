// READ: the edges of a robot as its next revision sees them.
#pragma once

#include <vector>

#include "server/model/approval/standing.h"
#include "server/model/edges/merged_edge.h"
#include "storage/edges/edges.h"
#include "storage/revisions/merged_edges.h"
#include "storage/store.h"

namespace rigcal::pipeline {

struct CurrentEdges {
  std::vector<Edge> edges;         // that are in no merged edge, good and failed, sorted by id
  std::vector<MergedEdge> merged;  // what the newest revision made of the others
  bool all = false;                // what it made of them holds no more: `edges` are all
  storage::WhatCounts counts;      // by which edges are past
};
// Edges that were retired, those of a session or sensor that was, those of a superseded session, and those of a sensor
// of which an epoch began since (it was remounted, say) are failed, with that as their only diagnosis (IsPast). Where
// that changes for edges that were merged, no edge is merged. Call within one Read.
[[nodiscard]] Result<CurrentEdges> LoadCurrentEdges(storage::Store& store, const RobotId& robot,
                                                    storage::EdgeParts parts);
// Of sessions whose edges are not among `current`: ids, ends and state, past ones with their reason. Call within one
// Read.
[[nodiscard]] Result<std::vector<Edge>> LoadEdgesWithin(storage::Store& store, const CurrentEdges& current,
                                                        const std::vector<SessionId>& sessions);
// Edges that do not count are failed, with the reason as their only diagnosis (IsPast): of several reasons what a
// person said of the edge itself, of its sensor, of its session, in this order.
[[nodiscard]] Status MarkPast(storage::Store& store, const storage::WhatCounts& counts, std::vector<Edge>& edges);

}  // namespace rigcal::pipeline
