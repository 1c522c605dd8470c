// An edge's row and those that belong to it, before it counts. For storage/*.cc only, inside an Append.
#pragma once

#include "server/model/edges/edge.h"
#include "storage/store.h"

namespace rigcal::storage {

// Whether the edge can be stored, as AppendEdge says (edges.h).
[[nodiscard]] Status CheckEdgeRow(const Edge& edge);
// Inserts as AppendEdge does, but the edge does not count yet; a no-op if the id exists. Its robot must be known, and
// the edge have passed CheckEdgeRow. The row's number.
[[nodiscard]] std::int64_t InsertEdgeRow(Store& store, const Edge& edge, Stamp now);

}  // namespace rigcal::storage
