// Boards as reference standards: the order that enters what was measured, and what is told of boards.
#pragma once

#include <string>
#include <vector>

#include "server/base/stamp.h"
#include "server/formats/answers/parameters.h"
#include "server/formats/boards/answers.h"
#include "server/model/approval/order.h"
#include "server/model/boards/remark.h"
#include "server/model/edges/edge.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// Order measure_board: `serial`, `measured_x_m`, `measured_y_m`, `who`; of a board that is not in the registry `type`,
// `cols`, `rows` (as session.yaml has them) and `square_m`, else these are as before. Optional: `length_x_m`,
// `length_y_m` (else the nearest multiple of 100 mm), `sigma_m`, `flatness_m`, `next_check` (a day), `reason`.
// kConflict where the registry has another pattern under that serial, unless `redefine`. The size of before and how
// much depends on the board are in the answer; nothing is computed anew by it.
[[nodiscard]] Result<OrderDone> MeasureBoard(storage::Store& store, const Clock& clock,
                                             const formats::Parameters& parameters);

// READ. Verb boards: up to `limit` (1 to 1000) boards by serial, those after `after`; on the first part also the
// serials that sessions name and the registry has not, up to as many.
[[nodiscard]] Result<formats::BoardsAnswer> LoadBoardsAnswer(storage::Store& store, Stamp now,
                                                             const formats::Parameters& parameters);
// Verb board: `serial`. kNotFound says whether sessions name it.
[[nodiscard]] Result<std::string> TellBoard(storage::Store& store, Stamp now, const formats::Parameters& parameters);
// Verb board_trace: `serial`, in the registry or not: what depends on it. kNotFound where neither knows it.
[[nodiscard]] Result<std::string> TraceBoard(storage::Store& store, const formats::Parameters& parameters);

// READ: what the registry says of the boards that sessions used, as fleet/boards/remarks.h, in the order of the ids; of
// boards that no sensor saw as seen_boards.h says.
[[nodiscard]] Result<std::vector<BoardRemark>> LoadBoardRemarks(storage::Store& store,
                                                                const std::vector<SessionId>& sessions);
// The sessions of edges that count.
[[nodiscard]] std::vector<SessionId> SessionsCountedIn(const std::vector<Edge>& edges);

}  // namespace rigcal::pipeline
