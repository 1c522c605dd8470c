#include "storage/boards/measures.h"

#include <set>

#include "storage/audit.h"
#include "storage/database/query.h"
#include "storage/sessions/standing.h"
#include "storage/sessions/standing_row.h"

namespace rigcal::storage {
namespace {

std::string BoardSubject(const std::string& serial) { return "what was measured of board " + serial; }

const std::string kMeasureColumns =
    "SELECT number, serial, kind, col_count, row_count, square_m, length_x_m, length_y_m, measured_x_m, measured_y_m, "
    "sigma_m, sigma_is_assumed, flatness_m, next_check_ns, at_ns, who, reason FROM board_measure m ";

Result<BoardMeasure> MeasureOf(const Query& query) {
  BoardMeasure measure;
  measure.number = query.Int(0);
  measure.serial = query.Text(1);
  RIGCAL_ASSIGN(measure.pattern.kind, TargetKindOf(query.Text(2)));
  measure.pattern.cols = static_cast<int>(query.Int(3));
  measure.pattern.rows = static_cast<int>(query.Int(4));
  measure.pattern.square_m = query.Real(5);
  measure.length_x_m = query.Real(6), measure.length_y_m = query.Real(7);
  measure.measured_x_m = query.Real(8), measure.measured_y_m = query.Real(9);
  measure.sigma_m = query.Real(10);
  measure.sigma_is_assumed = query.Int(11) != 0;
  if (!query.IsNull(12)) measure.flatness_m = query.Real(12);
  if (!query.IsNull(13)) measure.next_check_at = query.Time(13);
  measure.word = {query.Time(14), query.Text(15), query.Text(16)};
  return measure;
}

Result<std::vector<BoardMeasure>> MeasuresOf(Query& query) {
  std::vector<BoardMeasure> measures;
  while (query.Step()) {
    RIGCAL_ASSIGN(BoardMeasure one, MeasureOf(query));
    measures.push_back(std::move(one));
  }
  return measures;
}

// Its number.
std::int64_t InsertMeasure(Store& store, const BoardMeasure& measure) {
  return Query(store,
               "INSERT INTO board_measure (serial, kind, col_count, row_count, square_m, length_x_m, length_y_m, "
               "measured_x_m, "
               "measured_y_m, sigma_m, sigma_is_assumed, flatness_m, next_check_ns, at_ns, who, reason) "
               "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?) RETURNING number")
      .Bind(measure.serial, NameOf(measure.pattern.kind), measure.pattern.cols, measure.pattern.rows,
            measure.pattern.square_m, measure.length_x_m, measure.length_y_m, measure.measured_x_m,
            measure.measured_y_m, measure.sigma_m, measure.sigma_is_assumed, measure.flatness_m, measure.next_check_at,
            measure.word.at, measure.word.who, measure.word.reason)
      .RunForKey()
      .value();
}

std::string MeasureAuditText(const BoardMeasure& measure, const std::optional<BoardMeasure>& before) {
  std::string text =
      "measured board " + measure.serial + ", a " + TextOf(measure.pattern) + ": " + TextOf(SizeOf(measure));
  if (before && !IsSameSize(*before, measure)) text += ", before " + TextOf(SizeOf(*before));
  if (before && before->pattern != measure.pattern) text += ", before a " + TextOf(before->pattern);
  if (measure.next_check_at) text += ", next check " + ToIso(*measure.next_check_at).substr(0, 10);
  return text + Because(measure.word);
}

}  // namespace

Result<BoardMeasure> AppendBoardMeasure(Store& store, const BoardMeasure& measure) {
  RIGCAL_TRY(CheckWord(measure.word));
  RIGCAL_TRY(Validate(measure));
  return Append<BoardMeasure>(store, BoardSubject(measure.serial), [&]() -> Result<BoardMeasure> {
    RIGCAL_ASSIGN(const auto before, LoadBoardMeasure(store, measure.serial));
    if (before && IsSameCheck(*before, measure)) return *before;
    BoardMeasure next = measure;
    next.number = InsertMeasure(store, next);
    RIGCAL_TRY(AppendAudit(store, measure.word.at, measure.word.who, MeasureAuditText(next, before), {},
                           AuditedRow{AuditedKind::kBoardMeasure, next.number}));
    return next;
  });
}

Result<std::optional<BoardMeasure>> LoadBoardMeasure(Store& store, const std::string& serial) {
  RIGCAL_ASSIGN(const auto newest, LoadBoardHistory(store, serial, 1));
  return newest.empty() ? std::nullopt : std::optional(newest.front());
}

Result<std::vector<BoardMeasure>> LoadBoardHistory(Store& store, const std::string& serial, std::int64_t limit) {
  return Load<std::vector<BoardMeasure>>(store, BoardSubject(serial), [&]() -> Result<std::vector<BoardMeasure>> {
    Query query(store, kMeasureColumns + "WHERE serial = ? ORDER BY number DESC LIMIT ?");
    return MeasuresOf(query.Bind(serial, limit));
  });
}

Result<std::vector<BoardMeasure>> LoadBoards(Store& store, const std::string& after, std::int64_t limit) {
  return Load<std::vector<BoardMeasure>>(store, "the registry of boards", [&]() -> Result<std::vector<BoardMeasure>> {
    Query query(store, kMeasureColumns +
                           "WHERE serial > ? AND NOT EXISTS (SELECT 1 FROM board_measure later "
                           "WHERE later.serial = m.serial AND later.number > m.number) ORDER BY serial LIMIT ?");
    return MeasuresOf(query.Bind(after, limit));
  });
}

Result<std::int64_t> CountBoards(Store& store) {
  return Load<std::int64_t>(store, "the registry of boards", [&]() -> Result<std::int64_t> {
    Query query(store, "SELECT count(DISTINCT serial) FROM board_measure");
    return query.Step() ? query.Int(0) : 0;
  });
}

Result<BoardRegistry> LoadRegistryOf(Store& store, const std::vector<SessionBoard>& boards) {
  std::set<std::string> serials;
  for (const SessionBoard& board : boards)
    if (!board.serial.empty()) serials.insert(board.serial);
  BoardRegistry registry;
  for (const std::string& serial : serials) {
    RIGCAL_ASSIGN(auto known, LoadBoardMeasure(store, serial));
    if (known) registry.emplace(serial, std::move(*known));
  }
  return registry;
}

}  // namespace rigcal::storage
