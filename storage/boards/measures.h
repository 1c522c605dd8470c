// What people measured of calibration boards: the registry of reference standards. Append-only: of each serial the
// newest measure holds.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/model/boards/remark.h"
#include "storage/store.h"

namespace rigcal::storage {

// Noted in the audit, with size and, where that changed, the size before. `measure.number` is not looked at. The newest
// as it is, and no change, where it is the same check (IsSameCheck). kInvalidInput where it is not valid.
[[nodiscard]] Result<BoardMeasure> AppendBoardMeasure(Store& store, const BoardMeasure& measure);

// The newest; nothing: the serial is not in the registry.
[[nodiscard]] Result<std::optional<BoardMeasure>> LoadBoardMeasure(Store& store, const std::string& serial);
// All that was ever measured of a board, the newest first, at most `limit`.
[[nodiscard]] Result<std::vector<BoardMeasure>> LoadBoardHistory(Store& store, const std::string& serial,
                                                                 std::int64_t limit = kAllRows);
// The newest of each board, by serial: those after `after`, at most `limit`.
[[nodiscard]] Result<std::vector<BoardMeasure>> LoadBoards(Store& store, const std::string& after = {},
                                                           std::int64_t limit = kAllRows);
// How many boards are in the registry.
[[nodiscard]] Result<std::int64_t> CountBoards(Store& store);
// The newest of those serials that are in the registry.
[[nodiscard]] Result<BoardRegistry> LoadRegistryOf(Store& store, const std::vector<SessionBoard>& boards);

}  // namespace rigcal::storage
