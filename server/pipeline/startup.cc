#include "server/pipeline/startup.h"

#include "server/formats/documents.h"
#include "server/pipeline/validity.h"
#include "storage/edges.h"
#include "storage/revisions.h"
#include "storage/sessions.h"

namespace rigcal::pipeline {
namespace {

Status AnnounceRobot(storage::Store& store, const RobotId& robot, const Announcer& announcer) {
  RIGCAL_ASSIGN(const auto newest, storage::LoadRevisionSummary(store, robot, 0));
  if (!newest) return {};
  RIGCAL_ASSIGN(const std::int64_t edges, storage::CountEdges(store, robot, newest->edge_watermark));
  announcer.status(*newest, edges);
  RIGCAL_ASSIGN(const auto usable, LoadUsable(store, *newest));
  if (!usable) return {};
  RIGCAL_ASSIGN(const auto revision, storage::LoadRevision(store, robot, usable->number));
  if (!revision) return {};
  RIGCAL_ASSIGN(const auto document, formats::ReadRevisionDocument(revision->document));
  announcer.calibration(*revision, document.reference, document.solution.poses);
  return {};
}

}  // namespace

Status AnnounceStored(storage::Store& store, const Announcer& announcer) {
  RIGCAL_ASSIGN(const auto robots, storage::LoadRobots(store));
  for (const storage::RobotRow& row : robots) RIGCAL_TRY(AnnounceRobot(store, row.robot, announcer));
  return {};
}

}  // namespace rigcal::pipeline
