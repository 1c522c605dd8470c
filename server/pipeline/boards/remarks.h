// READ: what the registry of boards says of the boards that sessions used.
#pragma once

#include <vector>

#include "server/model/boards/remark.h"
#include "server/model/edges/edge.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// As fleet/boards/remarks.h, in the order of the ids.
[[nodiscard]] Result<std::vector<BoardRemark>> LoadBoardRemarks(storage::Store& store,
                                                                const std::vector<SessionId>& sessions);
// The sessions of edges that count.
[[nodiscard]] std::vector<SessionId> SessionsCountedIn(const std::vector<Edge>& edges);

}  // namespace rigcal::pipeline
