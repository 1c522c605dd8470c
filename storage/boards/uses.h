// Which boards closed sessions used, and what depends on a board: the reverse trace of a reference standard.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/model/boards/remark.h"
#include "server/model/boards/trace.h"
#include "storage/store.h"

namespace rigcal::storage {

// The boards of these sessions, in the order of the ids and of the targets' names; of those that are not closed none.
[[nodiscard]] Result<std::vector<SessionBoard>> LoadSessionBoards(Store& store, const std::vector<SessionId>& sessions);

// How many closed sessions name this serial.
[[nodiscard]] Result<std::int64_t> CountSessionsWith(Store& store, const std::string& serial);
// Serials that sessions name and the registry has not, sorted: those after `after`, at most `limit`.
[[nodiscard]] Result<std::vector<std::string>> LoadUnregistered(Store& store, const std::string& after,
                                                                std::int64_t limit);
// A board as the newest session with this serial has it; nothing: no session names it.
[[nodiscard]] Result<std::optional<SessionBoard>> LoadNewestUse(Store& store, const std::string& serial);

// All that depends on the board with this serial, by robot.
[[nodiscard]] Result<BoardTrace> LoadBoardTrace(Store& store, const std::string& serial);

}  // namespace rigcal::storage
