#include "server/pipeline/live.h"

#include <algorithm>

#include "server/formats/answers.h"
#include "server/pipeline/robot_rows.h"
#include "storage/jobs.h"
#include "storage/revisions.h"
#include "storage/sessions.h"

namespace rigcal::pipeline {
namespace {

Result<std::int64_t> CountUnfinished(storage::Store& store, const RobotId& robot) {
  RIGCAL_ASSIGN(const auto unsolved, storage::LoadUnsolvedRobots(store));
  RIGCAL_ASSIGN(const auto unpublished, storage::LoadUnpublished(store));
  return std::count_if(unsolved.begin(), unsolved.end(),
                       [&](const RobotId& one) { return robot.empty() || one == robot; }) +
         std::count_if(unpublished.begin(), unpublished.end(),
                       [&](const storage::RevisionKey& key) { return robot.empty() || key.robot == robot; });
}

// Sessions that are still arriving, or whose pairs are still being calibrated.
Status TakeOpenSessions(storage::Store& store, formats::LiveAnswer& answer) {
  RIGCAL_ASSIGN(auto rows, LoadSessionRows(store, answer.robot));
  for (formats::SessionAnswer& row : rows)
    if (!row.closed || row.jobs_waiting > 0) answer.open_sessions.push_back(std::move(row));
  if (!answer.open_sessions.empty()) RIGCAL_TRY(AddStanding(store, answer.robot, answer.open_sessions));
  RIGCAL_ASSIGN(const auto newest, storage::LoadRevisionSummary(store, answer.robot, 0));
  answer.revision = newest ? newest->number : 0;
  return {};
}

}  // namespace

Result<std::string> LiveDocument(storage::Store& store, const RobotId& robot) {
  formats::LiveAnswer answer;
  answer.robot = robot;
  RIGCAL_ASSIGN(const auto robots, storage::LoadRobots(store));
  for (const storage::RobotRow& row : robots) {
    if (!robot.empty() && row.robot != robot) continue;
    ++answer.robots;
    answer.sessions += row.sessions;
    answer.edges += row.edges;
  }
  RIGCAL_ASSIGN(answer.unfinished, CountUnfinished(store, robot));
  if (!robot.empty()) RIGCAL_TRY(TakeOpenSessions(store, answer));
  return formats::WriteLive(answer);
}

}  // namespace rigcal::pipeline
