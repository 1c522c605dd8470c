// Numbered revisions, append-only, and which of them are published.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "server/model/graph/graph.h"
#include "storage/store.h"

namespace rigcal::storage {

// Appends with the next number of the robot (1, 2, ...) and returns it. Call inside Write. `calibrated_at` is part of
// it. The document is kept compressed, up to limits::kRevisionBytesMax.
[[nodiscard]] Result<int> AppendRevision(Store& store, const Revision& revision);
// number 0: the newest. kStorage where its document is damaged.
[[nodiscard]] Result<std::optional<Revision>> LoadRevision(Store& store, const RobotId& robot, int number);
// The same without the document, which may be many megabytes.
[[nodiscard]] Result<std::optional<Revision>> LoadRevisionSummary(Store& store, const RobotId& robot, int number);
// Without documents; newest first, up to `limit` with numbers below `before` (0: from the newest on).
[[nodiscard]] Result<std::vector<Revision>> LoadRevisions(Store& store, const RobotId& robot, int before = 0,
                                                          std::int64_t limit = kAllRows);
// When those of `numbers` that there are were made.
[[nodiscard]] Result<std::map<int, Stamp>> LoadCreatedAt(Store& store, const RobotId& robot,
                                                         const std::vector<int>& numbers);
// Of each of the sessions with edges that began to count up to `watermark`: the first revision that has all of these.
[[nodiscard]] Result<std::map<SessionId, int>> LoadFirstRevisions(Store& store, const RobotId& robot,
                                                                  std::int64_t watermark,
                                                                  const std::vector<SessionId>& sessions);
// Robots with edges whose newest edge, newest standing (standing.h) or own policy is not in their newest revision, or
// that have none: first those with a policy of their own, then by when the first of that came.
[[nodiscard]] Result<std::vector<RobotId>> LoadUnsolvedRobots(Store& store);
// Likewise, or that a policy of its fleet or rig model is not in it (policies.h).
[[nodiscard]] Result<bool> IsUnsolved(Store& store, const RobotId& robot);
// When the oldest edge of the robot that is in no revision was stored; nothing: there is none.
[[nodiscard]] Result<std::optional<Stamp>> LoadUnsolvedSince(Store& store, const RobotId& robot);

struct RevisionKey {
  RobotId robot;
  int number = 0;
};
// The newest of each of the next `max` robots after `after`, by id; 0: it has none.
[[nodiscard]] Result<std::vector<RevisionKey>> LoadNewestRevisions(Store& store, const RobotId& after, int max);
// Revisions whose report is still to be drawn: of the robot whose oldest such revision was made first, by number.
[[nodiscard]] Result<std::vector<RevisionKey>> LoadUnpublished(Store& store);
[[nodiscard]] Result<std::int64_t> CountUnpublished(Store& store, const RobotId& robot);
// To be published, perhaps again; false if it was already.
[[nodiscard]] Result<bool> QueuePublication(Store& store, const RevisionKey& key);
[[nodiscard]] Result<bool> IsPublished(Store& store, const RevisionKey& key);
// The robot's newest revision, once more: what it shows was not all there. A no-op without a revision.
[[nodiscard]] Status PublishAgain(Store& store, const RobotId& robot);
[[nodiscard]] Status AppendPublication(Store& store, const RevisionKey& key, Stamp now);

}  // namespace rigcal::storage
