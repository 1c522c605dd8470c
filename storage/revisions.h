// Numbered revisions, append-only, and which of them are published.
#pragma once

#include <optional>
#include <vector>

#include "server/model/graph.h"
#include "storage/store.h"

namespace rigcal::storage {

// Appends with the next number of the robot (1, 2, ...) and returns it. Call inside Write.
[[nodiscard]] Result<int> AppendRevision(Store& store, const Revision& revision);
// number 0: the newest.
[[nodiscard]] Result<std::optional<Revision>> LoadRevision(Store& store, const RobotId& robot, int number);
// The same without the document, which may be many megabytes.
[[nodiscard]] Result<std::optional<Revision>> LoadRevisionSummary(Store& store, const RobotId& robot, int number);
// Without documents; newest first.
[[nodiscard]] Result<std::vector<Revision>> LoadRevisions(Store& store, const RobotId& robot);
// Robots whose newest edge is not in their newest revision (or who have edges and no revision).
[[nodiscard]] Result<std::vector<RobotId>> LoadUnsolvedRobots(Store& store);

struct RevisionKey {
  RobotId robot;
  int number = 0;
};
[[nodiscard]] Result<std::vector<RevisionKey>> LoadUnpublished(Store& store);
[[nodiscard]] Result<bool> IsPublished(Store& store, const RevisionKey& key);
// The robot's newest revision, once more: what it shows was not all there. A no-op without a revision.
[[nodiscard]] Status PublishAgain(Store& store, const RobotId& robot);
[[nodiscard]] Status AppendPublication(Store& store, const RevisionKey& key, Stamp now);

// Append-only audit trail: who did what.
[[nodiscard]] Status AppendAudit(Store& store, Stamp now, const std::string& who, const std::string& what);

}  // namespace rigcal::storage
