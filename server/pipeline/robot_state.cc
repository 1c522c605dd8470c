#include "server/pipeline/robot_state.h"

#include "server/formats/documents.h"
#include "server/pipeline/validity.h"
#include "storage/edges.h"
#include "storage/revisions.h"

namespace rigcal::pipeline {
namespace {

Result<RobotState::Calibration> LoadCalibration(storage::Store& store, const RobotId& robot, int number) {
  RIGCAL_ASSIGN(auto revision, storage::LoadRevision(store, robot, number));
  if (!revision)
    return Fail(ErrorCode::kNotFound, "robot " + robot.str() + " has no revision " + std::to_string(number),
                "See its revisions with: rigcal show " + robot.str());
  RIGCAL_ASSIGN(auto document, formats::ReadRevisionDocument(revision->document));
  revision->document.clear();
  return RobotState::Calibration{std::move(*revision), document.reference, std::move(document.solution.poses)};
}

}  // namespace

Result<std::optional<RobotState>> LoadRobotState(storage::Store& store, const RobotId& robot) {
  RobotState state;
  RIGCAL_ASSIGN(auto newest, storage::LoadRevisionSummary(store, robot, 0));
  if (!newest) return std::nullopt;
  state.newest = std::move(*newest);
  RIGCAL_ASSIGN(state.edges, storage::CountEdges(store, robot, state.newest.edge_watermark));
  RIGCAL_ASSIGN(const auto usable, LoadUsable(store, state.newest));
  if (!usable) return state;
  RIGCAL_ASSIGN(state.calibration, LoadCalibration(store, robot, usable->number));
  return state;
}

}  // namespace rigcal::pipeline
