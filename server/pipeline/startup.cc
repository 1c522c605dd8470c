#include "server/pipeline/startup.h"

#include "server/formats/documents.h"
#include "storage/revisions.h"
#include "storage/sessions.h"

namespace rigcal::pipeline {

Status AnnounceStored(storage::Store& store, const Announcer& announcer) {
  RIGCAL_ASSIGN(const auto robots, storage::LoadRobots(store));
  for (const storage::RobotRow& row : robots) {
    RIGCAL_ASSIGN(const auto revision, storage::LoadRevision(store, row.robot, 0));
    if (!revision) continue;
    RIGCAL_ASSIGN(const auto document, formats::ReadRevisionDocument(revision->document));
    announcer.calibration(*revision, document.reference, document.solution.poses,
                          static_cast<std::int64_t>(document.edges.size()));
  }
  return {};
}

}  // namespace rigcal::pipeline
