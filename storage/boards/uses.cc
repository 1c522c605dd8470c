#include "storage/boards/uses.h"

#include "storage/database/query.h"

namespace rigcal::storage {
namespace {

std::string UsesSubject(const std::string& serial) { return "sessions with board " + serial; }

const std::string kBoardColumns =
    "SELECT s.session_id, s.captured_ns, b.target_id, b.serial, b.kind, b.col_count, b.row_count, b.square_m, "
    "b.square_sigma_m ";

Result<SessionBoard> SessionBoardOf(const Query& query) {
  SessionBoard board;
  board.session = query.IdAt<SessionId>(0);
  board.captured_at = query.Time(1);
  board.target = query.IdAt<TargetId>(2);
  board.serial = query.Text(3);
  RIGCAL_ASSIGN(board.pattern.kind, TargetKindOf(query.Text(4)));
  board.pattern.cols = static_cast<int>(query.Int(5));
  board.pattern.rows = static_cast<int>(query.Int(6));
  board.pattern.square_m = query.Real(7);
  board.square_sigma_m = query.Real(8);
  return board;
}

}  // namespace

Result<std::vector<SessionBoard>> LoadSessionBoards(Store& store, const std::vector<SessionId>& sessions) {
  using Boards = std::vector<SessionBoard>;
  return Load<Boards>(store, "boards of sessions", [&]() -> Result<Boards> {
    Query query(store, kBoardColumns +
                           "FROM json_each(?) j CROSS JOIN session s ON s.session_id = j.value "
                           "CROSS JOIN session_board b ON b.session_number = s.number ORDER BY j.key, b.target_id");
    query.Bind(ListOf(sessions));
    Boards boards;
    while (query.Step()) {
      RIGCAL_ASSIGN(SessionBoard one, SessionBoardOf(query));
      boards.push_back(std::move(one));
    }
    return boards;
  });
}

Result<std::int64_t> CountSessionsWith(Store& store, const std::string& serial) {
  return Load<std::int64_t>(store, UsesSubject(serial), [&]() -> Result<std::int64_t> {
    Query query(store, "SELECT count(DISTINCT session_number) FROM session_board WHERE serial = ? AND serial <> ''");
    return query.Bind(serial).Step() ? query.Int(0) : 0;
  });
}

// From each name to the next: there are few boards, and very many sessions of each.
Result<std::vector<std::string>> LoadUnregistered(Store& store, const std::string& after, std::int64_t limit) {
  using Serials = std::vector<std::string>;
  return Load<Serials>(store, "boards that are not in the registry", [&]() -> Result<Serials> {
    Serials serials;
    std::string last = after;
    while (static_cast<std::int64_t>(serials.size()) < limit) {
      Query next(store, "SELECT min(serial) FROM session_board WHERE serial > ? AND serial <> ''");
      if (!next.Bind(last).Step() || next.IsNull(0)) break;
      last = next.Text(0);
      if (!Query(store, "SELECT 1 FROM board_measure WHERE serial = ? LIMIT 1").Bind(last).Step())
        serials.push_back(last);
    }
    return serials;
  });
}

Result<std::optional<SessionBoard>> LoadNewestUse(Store& store, const std::string& serial) {
  using Found = std::optional<SessionBoard>;
  return Load<Found>(store, UsesSubject(serial), [&]() -> Result<Found> {
    Query query(store, kBoardColumns +
                           "FROM session_board b CROSS JOIN session s ON s.number = b.session_number "
                           "WHERE b.serial = ? AND b.serial <> '' ORDER BY b.session_number DESC LIMIT 1");
    if (!query.Bind(serial).Step()) return Found();
    RIGCAL_ASSIGN(SessionBoard board, SessionBoardOf(query));
    return Found(std::move(board));
  });
}

}  // namespace rigcal::storage
