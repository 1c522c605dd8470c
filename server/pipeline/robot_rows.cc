#include "server/pipeline/robot_rows.h"

#include <algorithm>
#include <map>
#include <set>

#include "server/base/limits.h"
#include "server/pipeline/unknown_names.h"
#include "server/pipeline/validity.h"
#include "storage/edges.h"
#include "storage/jobs.h"
#include "storage/revisions.h"
#include "storage/sessions.h"
#include "storage/standing.h"

namespace rigcal::pipeline {
namespace {

Result<bool> HasWholeSession(storage::Store& store, const RobotId& robot) {
  RIGCAL_ASSIGN(const auto earliest, storage::LoadEarliestClosed(store, robot));
  return earliest.has_value();
}

// Of a robot that has nothing but a batch that is not whole.
Result<std::optional<Error>> IncompleteBatch(storage::Store& store, const RobotId& robot) {
  RIGCAL_ASSIGN(const auto batches, storage::LoadOpenBatches(store, robot));
  if (batches.empty()) return std::nullopt;
  const storage::OpenBatch& batch = batches.front();
  return Error{ErrorCode::kNotFound,
               "a batch of " + std::to_string(batch.items) + " edges is incomplete: " + std::to_string(batch.held) +
                   " of " + std::to_string(batch.items) + " since " + ToIso(batch.newest_at),
               "Push the same edges again: that completes it, and nothing is stored twice."};
}

// Of a robot without a revision. `whole`: a session of it came whole.
Verdict FirstVerdict(const formats::RobotAnswer& row, bool whole, const std::optional<Error>& incomplete) {
  const char* wait = "Wait: the result appears by itself.";
  if (!row.validity.given_up.empty()) return {VerdictLevel::kUnknown, row.validity.given_up, ""};
  if (row.jobs_waiting > 0) return {VerdictLevel::kUnknown, "The first session is being calibrated.", wait};
  if (row.edges > 0) return {VerdictLevel::kUnknown, "The first result is being worked out.", wait};
  if (whole)
    return {VerdictLevel::kUnknown, "No session of it has two sensors that can be calibrated against each other.",
            "Name at least two sensors in session.yaml that see one target, or that move together, and push it again."};
  if (row.sessions > 0)
    return {VerdictLevel::kUnknown, "The first session is arriving, or its push broke off.",
            "Wait a moment; if nothing changes, push it again: what is here already is not sent twice."};
  if (incomplete)
    return {VerdictLevel::kUnknown, "There is no revision yet: " + incomplete->what + ".", incomplete->cure};
  return {VerdictLevel::kUnknown, "There is no revision yet.", "Push a capture session or finished edges."};
}

Result<formats::RobotAnswer> RowOf(storage::Store& store, const storage::RobotRow& robot, Stamp now) {
  formats::RobotAnswer row;
  row.robot = robot.robot;
  row.sessions = robot.sessions;
  row.edges = robot.edges;
  RIGCAL_ASSIGN(row.jobs_waiting, storage::CountJobs(store, robot.robot));
  RIGCAL_ASSIGN(const auto revision, storage::LoadRevisionSummary(store, robot.robot, 0));
  if (!revision) {
    RIGCAL_TRY(LoadWhatIsNew(store, robot.robot, row.validity));
    RIGCAL_ASSIGN(const bool whole, HasWholeSession(store, robot.robot));
    RIGCAL_ASSIGN(const auto incomplete, IncompleteBatch(store, robot.robot));
    row.verdict = FirstVerdict(row, whole, incomplete);
    return row;
  }
  row.revision = revision->number;
  row.verdict = revision->verdict;
  RIGCAL_ASSIGN(row.validity, LoadValidity(store, *revision, now));
  // What arrived since is told once it is in a revision: one page shows the numbers of one revision.
  if (row.validity.calculating) {
    RIGCAL_ASSIGN(row.edges, storage::CountEdges(store, robot.robot, revision->edge_watermark));
  }
  return row;
}

Result<formats::SessionAnswer> RowOf(storage::Store& store, const storage::SessionRow& session) {
  formats::SessionAnswer row;
  row.session = session.id;
  row.robot = session.robot;
  row.closed = session.closed;
  row.payloads = session.payloads;
  row.payloads_held = session.payloads_held;
  row.bytes = session.bytes;
  row.captured_at = session.captured_at;
  row.opened_at = session.opened_at;
  if (session.closed) row.closed_at = session.closed_at;
  row.operator_name = session.operator_name;
  RIGCAL_ASSIGN(const storage::JobCount jobs, storage::CountJobs(store, session.id));
  row.jobs_waiting = jobs.waiting;
  row.jobs_total = jobs.total;
  return row;
}

}  // namespace

Result<std::vector<storage::RobotRow>> LoadKnown(storage::Store& store, const RobotId& robot) {
  if (robot.empty()) return storage::LoadRobots(store);
  RIGCAL_ASSIGN(const auto one, storage::LoadRobot(store, robot));
  if (one) return std::vector{*one};
  return Fail(UnknownRobot(store, robot));
}

Result<std::vector<formats::RobotAnswer>> LoadRobotRows(storage::Store& store, const RobotId& robot, Stamp now) {
  std::vector<formats::RobotAnswer> rows;
  RIGCAL_ASSIGN(const auto robots, LoadKnown(store, robot));
  for (const storage::RobotRow& item : robots) {
    RIGCAL_ASSIGN(auto row, RowOf(store, item, now));
    rows.push_back(std::move(row));
  }
  std::sort(rows.begin(), rows.end(), [](const auto& x, const auto& y) { return x.robot < y.robot; });
  return rows;
}

namespace {

Result<std::vector<formats::SessionAnswer>> RowsOf(storage::Store& store, const std::vector<storage::SessionRow>& sessions) {
  std::vector<formats::SessionAnswer> rows;
  for (const storage::SessionRow& item : sessions) {
    RIGCAL_ASSIGN(auto row, RowOf(store, item));
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

Result<std::vector<formats::SessionAnswer>> LoadSessionRows(storage::Store& store, const RobotId& robot, const SessionId& before,
                                                            std::int64_t limit) {
  RIGCAL_ASSIGN(const auto sessions, storage::LoadSessions(store, robot, before, limit));
  return RowsOf(store, sessions);
}

Result<std::vector<formats::SessionAnswer>> LoadOpenSessionRows(storage::Store& store, const RobotId& robot) {
  RIGCAL_ASSIGN(const auto sessions, storage::LoadOpenSessions(store, robot));
  return RowsOf(store, sessions);
}

namespace {

// Of one robot, of those of a page, or of all.
Result<std::map<SessionId, Superseding>> LoadSupersededOf(storage::Store& store, const RobotId& robot,
                                                          const std::vector<formats::SessionAnswer>& rows) {
  if (!robot.empty() || static_cast<std::int64_t>(rows.size()) > limits::kPageRowsMax) return storage::LoadSuperseded(store, robot);
  std::set<RobotId> robots;
  for (const formats::SessionAnswer& row : rows) robots.insert(row.robot);
  std::map<SessionId, Superseding> superseded;
  for (const RobotId& one : robots) {
    RIGCAL_ASSIGN(auto of_one, storage::LoadSuperseded(store, one));
    superseded.merge(of_one);
  }
  return superseded;
}

}  // namespace

Status AddStanding(storage::Store& store, const RobotId& robot, std::vector<formats::SessionAnswer>& rows) {
  RIGCAL_ASSIGN(const auto superseded, LoadSupersededOf(store, robot, rows));
  for (formats::SessionAnswer& row : rows) {
    RIGCAL_ASSIGN(row.standing, storage::LoadStanding(store, row.session));
    if (const auto found = superseded.find(row.session); found != superseded.end()) row.superseded_by = found->second;
    for (const auto& [old, superseding] : superseded)
      if (superseding.by == row.session) row.supersedes.push_back(old);
  }
  return {};
}

Result<formats::SessionAnswer> LoadSessionRow(storage::Store& store, const SessionId& id) {
  RIGCAL_ASSIGN(const auto session, storage::LoadSession(store, id));
  if (!session)
    return Fail(ErrorCode::kNotFound, "session " + id.str() + " is not known",
                "`rigcal sessions` lists those that are.");
  RIGCAL_ASSIGN(auto row, RowOf(store, *session));
  std::vector<formats::SessionAnswer> rows = {std::move(row)};
  RIGCAL_TRY(AddStanding(store, session->robot, rows));
  return std::move(rows.front());
}

namespace {

// `load` is one of storage's two ways to read a revision.
template <typename Load>
Result<Revision> RequiredRevision(Load load, storage::Store& store, const RobotId& robot, std::int64_t number) {
  constexpr std::int64_t kNumberMax = 1'000'000'000;
  if (number >= 0 && number <= kNumberMax) {
    RIGCAL_ASSIGN(auto revision, load(store, robot, static_cast<int>(number)));
    if (revision) return std::move(*revision);
  }
  if (number != 0)
    return Fail(ErrorCode::kNotFound, "robot '" + robot.str() + "' has no revision " + std::to_string(number),
                "Leave the number out to get the newest.");
  const std::string what = "robot '" + robot.str() + "' has no revision yet";
  RIGCAL_ASSIGN(const auto incomplete, IncompleteBatch(store, robot));
  if (incomplete) return Fail(incomplete->code, what + ": " + incomplete->what, incomplete->cure);
  return Fail(ErrorCode::kNotFound, what,
              "Push a capture session or finished edges; `rigcal robots` lists the robots that are known.");
}

}  // namespace

Result<Revision> LoadRevisionOf(storage::Store& store, const RobotId& robot, std::int64_t number) {
  return RequiredRevision(storage::LoadRevision, store, robot, number);
}

Result<Revision> LoadRevisionSummaryOf(storage::Store& store, const RobotId& robot, std::int64_t number) {
  return RequiredRevision(storage::LoadRevisionSummary, store, robot, number);
}

}  // namespace rigcal::pipeline
