#include "server/pipeline/boards/registry.h"

#include <cmath>
#include <set>

#include "server/base/limits.h"
#include "server/base/number_text.h"
#include "server/base/text.h"
#include "server/fleet/boards/remarks.h"
#include "server/model/edges/past.h"
#include "server/pipeline/boards/seen_boards.h"
#include "server/pipeline/robots/asked.h"
#include "storage/boards/measures.h"
#include "storage/boards/uses.h"

namespace rigcal::pipeline {
namespace {

using formats::Parameters;

constexpr std::size_t kTracedSessionsMax = 10'000;  // listed; all are counted

Result<std::optional<double>> OptionalLength(const Parameters& parameters, const std::string& name) {
  const auto text = parameters.Text(name);
  if (!text) return std::nullopt;
  if (const auto value = NumberIn<double>(*text); value && std::isfinite(*value)) return value;
  return Fail(ErrorCode::kInvalidInput, "the parameter '" + name + "' is no number: " + Quoted(*text),
              "Give metres, as a text of digits.");
}

Result<double> RequiredLength(const Parameters& parameters, const std::string& name) {
  RIGCAL_ASSIGN(const auto value, OptionalLength(parameters, name));
  if (value) return *value;
  return Fail(ErrorCode::kInvalidInput, "the parameter '" + name + "' is missing",
              "Say what the rule says, in metres.");
}

Result<int> CountAsked(const Parameters& parameters, const std::string& name) {
  RIGCAL_ASSIGN(const std::int64_t count, parameters.IntegerOr(name, 0));
  if (count >= 1 && count <= 1000) return static_cast<int>(count);
  return Fail(ErrorCode::kInvalidInput, "the parameter '" + name + "' is no count of a board",
              "Count as session.yaml does, 1 to 100.");
}

// Said whole, or not at all.
Result<std::optional<BoardPattern>> PatternAsked(const Parameters& parameters, const std::string& serial) {
  int said = 0;
  for (const char* name : {"type", "cols", "rows", "square_m"}) said += parameters.Text(name) ? 1 : 0;
  if (said == 0) return std::nullopt;
  if (said < 4)
    return Fail(ErrorCode::kInvalidInput, "what board " + Quoted(serial) + " is, is said in part only",
                "Give --type, --cols, --rows and --square-mm together; of a board that is known, none of them.");
  RIGCAL_ASSIGN(const TargetKind kind, TargetKindOf(*parameters.Text("type")));
  RIGCAL_ASSIGN(const int cols, CountAsked(parameters, "cols"));
  RIGCAL_ASSIGN(const int rows, CountAsked(parameters, "rows"));
  RIGCAL_ASSIGN(const double square_m, RequiredLength(parameters, "square_m"));
  return PatternTyped(kind, cols, rows, square_m);
}

Result<BoardPattern> PatternFor(const Parameters& parameters, const std::string& serial,
                                const std::optional<BoardMeasure>& before) {
  RIGCAL_ASSIGN(const auto asked, PatternAsked(parameters, serial));
  RIGCAL_ASSIGN(const bool redefine, parameters.Flag("redefine"));
  if (asked && before && *asked != before->pattern && !redefine)
    return Fail(ErrorCode::kConflict,
                "board " + Quoted(serial) + " is a " + TextOf(before->pattern) + " in the registry, and not a " +
                    TextOf(*asked),
                "Give another board a serial of its own; where the registry is wrong, say so with --redefine.");
  if (asked) return *asked;
  if (before) return before->pattern;
  return Fail(ErrorCode::kInvalidInput, "board " + Quoted(serial) + " is not in the registry yet",
              "Say what it is, once: --type, --cols, --rows and --square-mm, as they stand on the sheet.");
}

Status TakeLengths(const Parameters& parameters, BoardMeasure& measure) {
  RIGCAL_ASSIGN(measure.measured_x_m, RequiredLength(parameters, "measured_x_m"));
  RIGCAL_ASSIGN(measure.measured_y_m, RequiredLength(parameters, "measured_y_m"));
  RIGCAL_ASSIGN(const auto length_x_m, OptionalLength(parameters, "length_x_m"));
  RIGCAL_ASSIGN(const auto length_y_m, OptionalLength(parameters, "length_y_m"));
  measure.length_x_m = length_x_m.value_or(RulerLength_m(measure.measured_x_m));
  measure.length_y_m = length_y_m.value_or(RulerLength_m(measure.measured_y_m));
  RIGCAL_ASSIGN(const auto sigma_m, OptionalLength(parameters, "sigma_m"));
  measure.sigma_m = sigma_m.value_or(kReadingSigma_m);
  measure.sigma_is_assumed = !sigma_m;
  RIGCAL_ASSIGN(measure.flatness_m, OptionalLength(parameters, "flatness_m"));
  return {};
}

// A day, without the time of it.
Status TakeNextCheck(const Parameters& parameters, BoardMeasure& measure) {
  const auto text = parameters.Text("next_check");
  if (!text) return {};
  const auto day = ParseIso(*text);
  if (!day || text->size() != 10)
    return Fail(ErrorCode::kInvalidInput, Quoted(*text) + " is no day of a next check", "Write it as 2027-05-31.");
  measure.next_check_at = *day;
  return {};
}

Result<BoardMeasure> MeasureAsked(const Clock& clock, const Parameters& parameters) {
  BoardMeasure measure;
  measure.word.at = clock.Now();
  RIGCAL_ASSIGN(measure.serial, RequiredText(parameters, "serial", "Say what is written on the board."));
  RIGCAL_ASSIGN(measure.word.who, RequiredWho(parameters, "Say who measured it."));
  measure.word.reason = parameters.Text("reason").value_or("");
  RIGCAL_TRY(TakeLengths(parameters, measure));
  RIGCAL_TRY(TakeNextCheck(parameters, measure));
  return measure;
}

Result<formats::BoardRow> RowOfBoard(storage::Store& store, BoardMeasure measure, Stamp now) {
  formats::BoardRow row;
  RIGCAL_ASSIGN(row.sessions, storage::CountSessionsWith(store, measure.serial));
  row.check_due = IsCheckDue(measure, now);
  row.measure = std::move(measure);
  return row;
}

Result<std::vector<formats::UnregisteredBoard>> LoadUnregisteredRows(storage::Store& store, std::int64_t limit) {
  RIGCAL_ASSIGN(const auto serials, storage::LoadUnregistered(store, "", limit));
  std::vector<formats::UnregisteredBoard> rows;
  for (const std::string& serial : serials) {
    RIGCAL_ASSIGN(const auto use, storage::LoadNewestUse(store, serial));
    RIGCAL_ASSIGN(const std::int64_t sessions, storage::CountSessionsWith(store, serial));
    if (use) rows.push_back({serial, use->pattern, sessions});
  }
  return rows;
}

Status UnknownBoard(storage::Store& store, const std::string& serial) {
  RIGCAL_ASSIGN(const auto use, storage::LoadNewestUse(store, serial));
  if (!use)
    return Fail(ErrorCode::kNotFound, "board " + Quoted(serial) + " is not known",
                "`rigcal board list` lists those that are.");
  return Fail(ErrorCode::kNotFound, "board " + Quoted(serial) + " is not in the registry, though sessions name it",
              "Measure it: `" + MeasureCommand(serial, &use->pattern) + "`; `rigcal board trace " +
                  TypedSerial(serial) + "` lists the sessions.");
}

}  // namespace

Result<OrderDone> MeasureBoard(storage::Store& store, const Clock& clock, const Parameters& parameters) {
  RIGCAL_ASSIGN(BoardMeasure measure, MeasureAsked(clock, parameters));
  std::optional<BoardMeasure> before;
  RIGCAL_TRY(store.Write([&]() -> Status {
    RIGCAL_ASSIGN(before, storage::LoadBoardMeasure(store, measure.serial));
    RIGCAL_ASSIGN(measure.pattern, PatternFor(parameters, measure.serial, before));
    RIGCAL_ASSIGN(measure, storage::AppendBoardMeasure(store, measure));
    return {};
  }));
  RIGCAL_ASSIGN(const BoardTrace trace, storage::LoadBoardTrace(store, measure.serial));  // it may be long
  RIGCAL_ASSIGN(const auto row, RowOfBoard(store, measure, clock.Now()));
  OrderDone done;
  done.document = formats::WriteBoardMeasured(row, before, trace);
  return done;
}

Result<formats::BoardsAnswer> LoadBoardsAnswer(storage::Store& store, Stamp now, const Parameters& parameters) {
  RIGCAL_ASSIGN(const std::int64_t limit, parameters.IntegerOr("limit", limits::kPageRowsMax));
  if (limit < 1 || limit > limits::kPageRowsMax)
    return Fail(ErrorCode::kInvalidInput, "the parameter 'limit' is out of range", "Ask for 1 to 1000 boards at once.");
  const std::string after = parameters.Text("after").value_or("");
  formats::BoardsAnswer answer;
  RIGCAL_TRY(store.Read([&]() -> Status {
    RIGCAL_ASSIGN(auto measures, storage::LoadBoards(store, after, limit + 1));
    const bool more = static_cast<std::int64_t>(measures.size()) > limit;
    if (more) measures.pop_back();
    if (more) answer.next = measures.back().serial;
    for (BoardMeasure& measure : measures) {
      RIGCAL_ASSIGN(auto row, RowOfBoard(store, std::move(measure), now));
      answer.boards.push_back(std::move(row));
    }
    if (!after.empty()) return {};
    RIGCAL_ASSIGN(answer.unregistered, LoadUnregisteredRows(store, limit));
    return {};
  }));
  return answer;
}

Result<std::string> TellBoard(storage::Store& store, Stamp now, const Parameters& parameters) {
  RIGCAL_ASSIGN(const std::string serial, RequiredText(parameters, "serial", "Say what is written on the board."));
  std::string document;
  RIGCAL_TRY(store.Read([&]() -> Status {
    RIGCAL_ASSIGN(const auto history, storage::LoadBoardHistory(store, serial, limits::kPageRowsMax));
    if (history.empty()) return UnknownBoard(store, serial);
    RIGCAL_ASSIGN(const auto row, RowOfBoard(store, history.front(), now));
    document = formats::WriteBoard(row, history);
    return {};
  }));
  return document;
}

Result<std::string> TraceBoard(storage::Store& store, const Parameters& parameters) {
  RIGCAL_ASSIGN(const std::string serial, RequiredText(parameters, "serial", "Say what is written on the board."));
  RIGCAL_ASSIGN(const BoardTrace trace, storage::LoadBoardTrace(store, serial));
  RIGCAL_ASSIGN(const auto known, storage::LoadBoardMeasure(store, serial));
  if (trace.robots.empty() && !known) RIGCAL_TRY(UnknownBoard(store, serial));
  return formats::WriteBoardTrace(serial, trace, kTracedSessionsMax);
}

Result<std::vector<BoardRemark>> LoadBoardRemarks(storage::Store& store, const std::vector<SessionId>& sessions) {
  RIGCAL_ASSIGN(const auto boards, storage::LoadSessionBoards(store, sessions));
  RIGCAL_ASSIGN(const BoardRegistry registry, storage::LoadRegistryOf(store, boards));
  std::vector<BoardRemark> remarks = fleet::RemarksOn(boards, registry);
  RIGCAL_TRY(LeaveOutUnseen(store, remarks));
  return remarks;
}

std::vector<SessionId> SessionsCountedIn(const std::vector<Edge>& edges) {
  std::set<SessionId> sessions;
  for (const Edge& edge : edges)
    if (!edge.session.empty() && !IsPast(edge)) sessions.insert(edge.session);
  return {sessions.begin(), sessions.end()};
}

}  // namespace rigcal::pipeline
