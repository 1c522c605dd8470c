#include "server/pipeline/recomputation/ask.h"

#include <algorithm>
#include <set>

#include "server/base/limits.h"
#include "server/base/text.h"
#include "server/base/version.h"
#include "server/formats/answers/recomputation.h"
#include "server/formats/boards/square_sizes.h"
#include "server/pipeline/robots/asked.h"
#include "server/pipeline/robots/decide.h"
#include "server/pipeline/robots/unknown_names.h"
#include "server/pipeline/sessions/session_refinement.h"
#include "storage/boards/measures.h"
#include "storage/boards/uses.h"
#include "storage/revisions/merged_edges.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/session_estimates.h"
#include "storage/sessions/sessions.h"
#include "storage/settings/policies.h"
#include "storage/work/recomputation_result.h"
#include "storage/work/recomputations.h"

namespace rigcal::pipeline {
namespace {

using formats::Parameters;

constexpr const char* kOneScope = "Give one of `all`, `model`, `robot` and `board`.";

// Which robots, and with which board as it was measured.
struct ScopeAsked {
  std::string scope, subject;
  std::optional<BoardMeasure> board = {};
};

Result<ScopeAsked> BoardScope(storage::Store& store, const std::string& serial) {
  RIGCAL_ASSIGN(auto measure, storage::LoadBoardMeasure(store, serial));
  if (measure) return ScopeAsked{"board", serial, std::move(measure)};
  return Fail(ErrorCode::kNotFound, "nobody measured board " + Quoted(serial),
              "Measure it first: `" + MeasureCommand(serial) + "`.");
}

Result<ScopeAsked> ModelScope(storage::Store& store, const std::string& model) {
  RIGCAL_ASSIGN(const bool is_known, storage::HasRigModel(store, model));
  if (is_known) return ScopeAsked{"model", model};
  return Fail(UnknownModel(store, model));
}

Result<ScopeAsked> ReadScope(storage::Store& store, const Parameters& parameters) {
  RIGCAL_ASSIGN(const bool all, parameters.Flag("all"));
  const auto model = parameters.Text("model"), robot = parameters.Text("robot"), board = parameters.Text("board");
  const int said = (all ? 1 : 0) + (model ? 1 : 0) + (robot ? 1 : 0) + (board ? 1 : 0);
  if (said != 1)
    return Fail(ErrorCode::kInvalidInput,
                said == 0 ? "nothing says which robots are to be computed again"
                          : "only one thing can say which robots are to be computed again",
                kOneScope);
  if (all) return ScopeAsked{"all", ""};
  if (model) return ModelScope(store, *model);
  if (board) return BoardScope(store, *board);
  RIGCAL_ASSIGN(const RobotId known, KnownRobot(store, parameters));
  return ScopeAsked{"robot", known.str()};
}

// By name; some have no revision.
Result<std::vector<RobotId>> RobotsIn(storage::Store& store, const ScopeAsked& asked) {
  std::vector<RobotId> robots;
  if (asked.scope == "robot") return std::vector{RobotId(asked.subject)};
  if (asked.scope == "board") {
    RIGCAL_ASSIGN(const BoardTrace trace, storage::LoadBoardTrace(store, asked.subject));
    for (const TracedRobot& traced : trace.robots) robots.push_back(traced.robot);
    return robots;
  }
  RIGCAL_ASSIGN(robots, storage::LoadRobotNames(store, "", storage::kAllRows));
  if (asked.scope == "all") return robots;
  std::vector<RobotId> of_model;
  for (const RobotId& robot : robots) {
    RIGCAL_ASSIGN(const std::string model, storage::LoadRigModel(store, robot));
    if (model == asked.subject) of_model.push_back(robot);
  }
  return of_model;
}

// Sizes as they were, and those of the targets that are this board.
Status TakeMeasured(storage::Store& store, const BoardMeasure& board, std::vector<SessionAsked>& sessions) {
  std::vector<SessionId> ids;
  for (const SessionAsked& session : sessions) ids.push_back(session.session);
  RIGCAL_ASSIGN(const auto boards, storage::LoadSessionBoards(store, ids));
  for (SessionAsked& session : sessions) {
    RIGCAL_ASSIGN(SquareSizes sizes, formats::ReadSquareSizes(session.sizes));
    for (const SessionBoard& one : boards)
      if (one.session == session.session && one.serial == board.serial && IsSamePattern(one.pattern, board.pattern))
        sizes[one.target] = SquareSizeOf(board);
    session.sizes = formats::WriteSquareSizes(sizes);
  }
  return {};
}

Result<std::vector<SessionAsked>> SessionsAnew(storage::Store& store, const RobotId& robot, const ScopeAsked& asked) {
  RIGCAL_ASSIGN(const auto bases, storage::LoadSessionBases(store, robot, kSessionsFused));
  std::vector<SessionAsked> sessions;
  for (const storage::SessionBasis& basis : bases) sessions.push_back({basis.session, basis.sizes});
  std::reverse(sessions.begin(), sessions.end());
  if (asked.board) RIGCAL_TRY(TakeMeasured(store, *asked.board, sessions));
  return sessions;
}

Result<std::vector<RobotAsked>> RobotsAnew(storage::Store& store, const ScopeAsked& asked) {
  RIGCAL_ASSIGN(const auto robots, RobotsIn(store, asked));
  std::vector<RobotAsked> anew;
  for (const RobotId& robot : robots) {
    RIGCAL_ASSIGN(const auto newest, storage::LoadRevisionSummary(store, robot, 0));
    if (!newest) continue;
    RIGCAL_ASSIGN(auto sessions, SessionsAnew(store, robot, asked));
    anew.push_back({robot, std::move(sessions)});
  }
  return anew;
}

struct RunToAsk {
  RecomputationRun run;
  std::vector<RobotAsked> robots;
};

// Of a large fleet that takes long: what is pushed meanwhile need not wait for it.
Result<RunToAsk> LoadRunToAsk(storage::Store& store, RecomputationRun run, const Parameters& parameters) {
  RunToAsk ask{std::move(run), {}};
  RIGCAL_TRY(store.Read([&]() -> Status {
    RIGCAL_ASSIGN(const ScopeAsked asked, ReadScope(store, parameters));
    ask.run.scope = asked.scope, ask.run.subject = asked.subject;
    RIGCAL_ASSIGN(ask.robots, RobotsAnew(store, asked));
    return {};
  }));
  if (!ask.robots.empty()) return ask;
  return Fail(ErrorCode::kNotFound,
              "there is nothing to compute again of " + ScopeText(ask.run) + ": no calibration yet",
              "`rigcal robots` lists the robots that there are.");
}

constexpr std::int64_t kRobotsTold = 100;

Result<formats::RecomputedRobotRow> RowOfRecomputed(storage::Store& store, RecomputedRobot done) {
  formats::RecomputedRobotRow row{std::move(done), RevisionState::kUnusable, ""};
  if (row.done.revision == 0) return row;
  RIGCAL_ASSIGN(const auto revision, storage::LoadRevisionSummary(store, row.done.robot, row.done.revision));
  if (!revision) return row;
  RIGCAL_ASSIGN(const Approval approval, LoadApproval(store, *revision));
  row.state = approval.state;
  row.verdict = NameOf(revision->verdict.level);
  return row;
}

Status TakeRows(storage::Store& store, std::int64_t limit, formats::RecomputationAnswer& answer) {
  RIGCAL_ASSIGN(answer.progress, storage::LoadRecomputationProgress(store, answer.run.number));
  RIGCAL_ASSIGN(answer.left, storage::LoadSessionsLeft(store, answer.run.number, limit));
  RIGCAL_ASSIGN(auto robots, storage::LoadRecomputedRobots(store, answer.run.number, limit));
  for (RecomputedRobot& done : robots) {
    RIGCAL_ASSIGN(auto row, RowOfRecomputed(store, std::move(done)));
    answer.robots.push_back(std::move(row));
  }
  return {};
}

}  // namespace

Result<OrderDone> AskToRecompute(storage::Store& store, const Clock& clock, const Parameters& parameters) {
  RecomputationRun run{0, "", "", "", clock.Now(), std::string(Version()), kSessionEstimator};
  RIGCAL_ASSIGN(run.who, RequiredWho(parameters, "Say who asks for it."));
  RIGCAL_ASSIGN(const RunToAsk ask, LoadRunToAsk(store, std::move(run), parameters));
  formats::RecomputationAnswer answer;
  RIGCAL_TRY(store.Write([&]() -> Status {
    RIGCAL_ASSIGN(const storage::RunAsked same_or_new, storage::AppendRecomputation(store, ask.run, ask.robots));
    RIGCAL_ASSIGN(const auto stored, storage::LoadRecomputation(store, same_or_new.number));
    answer.run = stored.value_or(ask.run);
    answer.is_new = same_or_new.is_new;
    RIGCAL_ASSIGN(answer.progress, storage::LoadRecomputationProgress(store, same_or_new.number));
    return {};
  }));
  return OrderDone{RobotId(ask.run.scope == "robot" ? ask.run.subject : ""), formats::WriteRecomputation(answer)};
}

Result<std::string> TellRecomputation(storage::Store& store, const Parameters& parameters) {
  RIGCAL_ASSIGN(const std::int64_t number, parameters.IntegerOr("run", 0));
  RIGCAL_ASSIGN(const std::int64_t limit, parameters.IntegerOr("limit", kRobotsTold));
  if (limit < 0 || limit > limits::kPageRowsMax)
    return Fail(ErrorCode::kInvalidInput, "the parameter 'limit' is out of range", "Ask for 0 to 1000 robots at once.");
  formats::RecomputationAnswer answer;
  RIGCAL_TRY(store.Read([&]() -> Status {
    RIGCAL_ASSIGN(const auto run, storage::LoadRecomputation(store, number));
    if (!run)
      return Fail(ErrorCode::kNotFound,
                  number > 0 ? "there is no run " + std::to_string(number) + " of `rigcal resolve`"
                             : "nothing was computed again yet",
                  "`rigcal resolve --all`, `--model M` or `rigcal resolve ROBOT` asks for it.");
    answer.run = *run;
    return TakeRows(store, limit, answer);
  }));
  return formats::WriteRecomputation(answer);
}

}  // namespace rigcal::pipeline
