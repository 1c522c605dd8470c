#include "server/pipeline/live.h"

#include "server/formats/answers.h"
#include "server/pipeline/robot_rows.h"
#include "storage/jobs.h"
#include "storage/revisions.h"
#include "storage/sessions.h"

namespace rigcal::pipeline {
namespace {

Result<std::int64_t> CountUnfinished(storage::Store& store, const RobotId& robot) {
  if (!robot.empty()) {
    RIGCAL_ASSIGN(const bool unsolved, storage::IsUnsolved(store, robot));
    RIGCAL_ASSIGN(const std::int64_t reports, storage::CountUnpublished(store, robot));
    return reports + (unsolved ? 1 : 0);
  }
  RIGCAL_ASSIGN(const auto unsolved, storage::LoadUnsolvedRobots(store));
  RIGCAL_ASSIGN(const auto unpublished, storage::LoadUnpublished(store));
  return static_cast<std::int64_t>(unsolved.size() + unpublished.size());
}

// Sessions that are still arriving, or whose pairs are still being calibrated.
Status TakeOpenSessions(storage::Store& store, formats::LiveAnswer& answer) {
  RIGCAL_ASSIGN(answer.open_sessions, LoadOpenSessionRows(store, answer.robot));
  if (!answer.open_sessions.empty()) RIGCAL_TRY(AddStanding(store, answer.robot, answer.open_sessions));
  RIGCAL_ASSIGN(const auto newest, storage::LoadRevisionSummary(store, answer.robot, 0));
  answer.revision = newest ? newest->number : 0;
  return {};
}

}  // namespace

Result<std::string> LiveDocument(storage::Store& store, const RobotId& robot) {
  formats::LiveAnswer answer;
  answer.robot = robot;
  RIGCAL_ASSIGN(const auto robots, LoadKnown(store, robot));
  for (const storage::RobotRow& row : robots) {
    ++answer.robots;
    answer.sessions += row.sessions;
    answer.edges += row.edges;
  }
  RIGCAL_ASSIGN(answer.unfinished, CountUnfinished(store, robot));
  if (!robot.empty()) RIGCAL_TRY(TakeOpenSessions(store, answer));
  return formats::WriteLive(answer);
}

}  // namespace rigcal::pipeline
