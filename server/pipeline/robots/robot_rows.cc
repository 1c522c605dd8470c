#include "server/pipeline/robots/robot_rows.h"

#include <algorithm>
#include <map>
#include <set>

#include "server/base/limits.h"
#include "server/pipeline/robots/summaries.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/retired.h"
#include "storage/sessions/sessions.h"
#include "storage/sessions/standing.h"
#include "storage/work/jobs.h"

namespace rigcal::pipeline {
namespace {

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

Result<std::vector<formats::SessionAnswer>> RowsOf(storage::Store& store,
                                                   const std::vector<storage::SessionRow>& sessions) {
  std::vector<formats::SessionAnswer> rows;
  for (const storage::SessionRow& item : sessions) {
    RIGCAL_ASSIGN(auto row, RowOf(store, item));
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

Result<std::vector<formats::SessionAnswer>> LoadSessionRows(storage::Store& store, const RobotId& robot,
                                                            const SessionId& before, std::int64_t limit) {
  RIGCAL_ASSIGN(const auto sessions, storage::LoadSessions(store, robot, before, limit));
  return RowsOf(store, sessions);
}

Result<std::vector<formats::SessionAnswer>> LoadOpenSessionRows(storage::Store& store, const RobotId& robot) {
  RIGCAL_ASSIGN(const auto sessions, storage::LoadOpenSessions(store, robot));
  return RowsOf(store, sessions);
}

namespace {

// What `load` tells of each robot of these rows, together.
template <typename Told, typename Load>
Result<std::map<SessionId, Told>> OfEachRobot(const std::vector<formats::SessionAnswer>& rows, const Load& load) {
  std::set<RobotId> robots;
  for (const formats::SessionAnswer& row : rows) robots.insert(row.robot);
  std::map<SessionId, Told> told;
  for (const RobotId& robot : robots) {
    RIGCAL_ASSIGN(auto of_one, load(robot));
    told.merge(of_one);
  }
  return told;
}

// Of one robot, of those of a page, or of all.
Result<std::map<SessionId, Superseding>> LoadSupersededOf(storage::Store& store, const RobotId& robot,
                                                          const std::vector<formats::SessionAnswer>& rows) {
  if (!robot.empty() || static_cast<std::int64_t>(rows.size()) > limits::kPageRowsMax)
    return storage::LoadSuperseded(store, robot);
  return OfEachRobot<Superseding>(rows, [&](const RobotId& one) { return storage::LoadSuperseded(store, one); });
}

Result<std::map<SessionId, Standing>> LoadRetiredOf(storage::Store& store,
                                                    const std::vector<formats::SessionAnswer>& rows) {
  return OfEachRobot<Standing>(rows, [&](const RobotId& one) { return storage::LoadRetiredSessions(store, one); });
}

}  // namespace

Result<std::vector<RetiredSensor>> LoadRetiredSensorsIn(storage::Store& store, const RobotId& robot,
                                                        const Manifest& manifest) {
  RIGCAL_ASSIGN(const auto retired, storage::LoadRetiredSensors(store, robot));
  std::vector<RetiredSensor> in_it;
  for (const auto& [sensor, standing] : retired)
    if (SensorOf(manifest.header, sensor) != nullptr) in_it.push_back({sensor, standing.word});
  return in_it;
}

Status AddStanding(storage::Store& store, const RobotId& robot, std::vector<formats::SessionAnswer>& rows) {
  RIGCAL_ASSIGN(const auto superseded, LoadSupersededOf(store, robot, rows));
  RIGCAL_ASSIGN(const auto retired, LoadRetiredOf(store, rows));
  for (formats::SessionAnswer& row : rows) {
    if (const auto found = retired.find(row.session); found != retired.end()) row.retired = found->second;
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
                "`rigcal history " + robot.str() + "` lists them.");
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
