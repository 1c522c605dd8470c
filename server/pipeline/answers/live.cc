#include "server/pipeline/answers/live.h"

#include "server/formats/answers/answers.h"
#include "server/pipeline/robots/robot_rows.h"
#include "server/pipeline/robots/summaries.h"
#include "storage/fleet/fleet_list.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/sessions.h"
#include "storage/work/jobs.h"

namespace rigcal::pipeline {
namespace {

Status TakeFleet(storage::Store& store, formats::LiveAnswer& answer) {
  RIGCAL_ASSIGN(const storage::FleetSize size, storage::LoadFleetSize(store));
  answer.robots = size.robots;
  answer.sessions = size.sessions;
  answer.edges = size.edges;
  answer.unfinished = size.unfinished;
  return {};
}

Status TakeRobot(storage::Store& store, formats::LiveAnswer& answer) {
  RIGCAL_ASSIGN(const storage::RobotRow row, LoadKnownRobot(store, answer.robot));
  answer.robots = 1;
  answer.sessions = row.sessions;
  answer.edges = row.edges;
  RIGCAL_ASSIGN(const bool unsolved, storage::IsUnsolved(store, answer.robot));
  RIGCAL_ASSIGN(const std::int64_t reports, storage::CountUnpublished(store, answer.robot));
  RIGCAL_ASSIGN(const std::int64_t jobs, storage::CountJobs(store, answer.robot));
  answer.unfinished = jobs + reports + (unsolved ? 1 : 0);
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
  RIGCAL_TRY(robot.empty() ? TakeFleet(store, answer) : TakeRobot(store, answer));
  return formats::WriteLive(answer);
}

}  // namespace rigcal::pipeline
