// The documents about boards as reference standards (docs/api.md, boards).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/formats/json/json_writer.h"
#include "server/model/boards/remark.h"
#include "server/model/boards/trace.h"

namespace rigcal::formats {

struct BoardRow {
  BoardMeasure measure;       // the newest
  bool check_due = false;     // the day of its next check is over
  std::int64_t sessions = 0;  // closed ones that name its serial
};
// A serial that sessions name and nobody measured.
struct UnregisteredBoard {
  std::string serial;
  BoardPattern pattern;  // as the newest of them has it
  std::int64_t sessions = 0;
};

// verb boards; `next`: the serial after which the next part begins, empty where nothing follows.
struct BoardsAnswer {
  std::vector<BoardRow> boards;
  std::vector<UnregisteredBoard> unregistered;
  std::string next;
};
[[nodiscard]] std::string WriteBoards(const BoardsAnswer& answer);

// verb board: its row, and all its measures, the newest first.
[[nodiscard]] std::string WriteBoard(const BoardRow& row, const std::vector<BoardMeasure>& history);

// verb board_trace. `sessions_max`: of the sessions so many are listed, the newest of each robot; the counts are of
// all.
[[nodiscard]] std::string WriteBoardTrace(const std::string& serial, const BoardTrace& trace, std::size_t sessions_max);

// order measure_board: the board from now on, what was measured before, and how much depends on it.
[[nodiscard]] std::string WriteBoardMeasured(const BoardRow& row, const std::optional<BoardMeasure>& before,
                                             const BoardTrace& trace);

// "board_remarks": a list, of the verbs session and show.
void WriteBoardRemarks(JsonWriter& out, const std::vector<BoardRemark>& remarks);

}  // namespace rigcal::formats
