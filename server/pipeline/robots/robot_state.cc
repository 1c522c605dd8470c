#include "server/pipeline/robots/robot_state.h"

#include <set>

#include "server/formats/documents.h"
#include "server/pipeline/robots/validity.h"
#include "storage/edges/edges.h"
#include "storage/revisions/decisions.h"
#include "storage/revisions/revisions.h"

namespace rigcal::pipeline {
namespace {

// Of revision `number`, its document read into what is told.
Result<RobotState::Calibration> LoadCalibration(storage::Store& store, const RobotId& robot, int number) {
  RIGCAL_ASSIGN(auto revision, storage::LoadRevision(store, robot, number));
  if (!revision)
    return Fail(ErrorCode::kNotFound, "robot " + robot.str() + " has no revision " + std::to_string(number),
                "See its revisions with: rigcal show " + robot.str());
  RIGCAL_ASSIGN(auto document, formats::ReadRevisionDocument(revision->document));
  revision->document.clear();
  return RobotState::Calibration{std::move(*revision), document.reference, std::move(document.solution.poses),
                                 document.solution.R_ref_robot};
}

// Poses of these may be with readers. Whoever told them may have ended before it could take them back, or before it
// told a later revision of fewer sensors: where none is in use, those that the newest revision knows of are taken back
// too.
Result<std::vector<SensorId>> LoadWithdrawn(storage::Store& store, const Revision& newest,
                                            const std::optional<RobotState::Calibration>& in_use) {
  RIGCAL_ASSIGN(const int told, storage::LoadNewestApproved(store, newest.robot));
  if (told == 0 || (in_use && in_use->revision.number == told)) return std::vector<SensorId>();
  std::set<SensorId> sensors;
  for (const int number : in_use ? std::vector<int>{told} : std::vector<int>{told, newest.number}) {
    RIGCAL_ASSIGN(const auto calibration, LoadCalibration(store, newest.robot, number));
    for (const SensorPose& pose : calibration.poses) sensors.insert(pose.sensor);
  }
  if (in_use)
    for (const SensorPose& pose : in_use->poses) sensors.erase(pose.sensor);
  return std::vector<SensorId>(sensors.begin(), sensors.end());
}

Result<RobotState> LoadStateOf(storage::Store& store, Revision newest) {
  RobotState state;
  RIGCAL_ASSIGN(state.edges, storage::CountEdges(store, newest.robot, newest.edge_watermark));
  RIGCAL_ASSIGN(const auto usable, LoadUsable(store, newest.robot));
  if (usable) {
    RIGCAL_ASSIGN(state.calibration, LoadCalibration(store, newest.robot, usable->number));
  }
  RIGCAL_ASSIGN(state.withdrawn, LoadWithdrawn(store, newest, state.calibration));
  state.newest = std::move(newest);
  return state;
}

}  // namespace

Result<std::optional<RobotState>> LoadRobotState(storage::Store& store, const RobotId& robot) {
  std::optional<RobotState> state;
  RIGCAL_TRY(store.Read([&]() -> Status {
    RIGCAL_ASSIGN(auto newest, storage::LoadRevisionSummary(store, robot, 0));
    if (!newest) return {};
    RIGCAL_ASSIGN(state, LoadStateOf(store, std::move(*newest)));
    return {};
  }));
  return state;
}

}  // namespace rigcal::pipeline
