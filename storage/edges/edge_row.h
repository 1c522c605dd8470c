// An edge's row and those that belong to it, before it counts. For storage/*.cc only, inside an Append.
#pragma once

#include "server/model/edges/edge.h"
#include "storage/store.h"

namespace rigcal::storage {

// Appends as AppendEdge does (edges.h), but the edge does not count yet; a no-op if the id exists. The row's number.
[[nodiscard]] Result<std::int64_t> AppendEdgeRow(Store& store, const Edge& edge, Stamp now);

}  // namespace rigcal::storage
