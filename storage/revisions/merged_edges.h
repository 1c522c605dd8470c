// Which edges of a robot its revisions take as they are, and the merged edges that stand for the others
// (merged_edge.h).
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/model/approval/epoch.h"
#include "server/model/approval/policy.h"
#include "server/model/approval/standing.h"
#include "server/model/edges/merged_edge.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/sessions.h"

namespace rigcal::storage {

// Of a revision, or of the newest (`number` 0), by frames and method, first parts before the others; scores of sessions
// only with those of the newest.
[[nodiscard]] Result<std::vector<MergedEdge>> LoadMergedEdges(Store& store, const RobotId& robot, int number = 0);

// The robot in whose newest revision a merged edge has this id.
[[nodiscard]] Result<std::optional<RobotId>> FindRobotOfMerged(Store& store, const EdgeId& id);

// Likewise those whose ids begin so, of all robots or of one.
[[nodiscard]] Result<std::vector<EdgeId>> FindMergedEdges(Store& store, const std::string& prefix,
                                                          const RobotId& robot);
// Good edges of the robot that are in no window, of the pair and method of `merged` and of sessions or pushed as it is:
// those that it stands for, and of a pair with several parts those of all; by id. What was retired, superseded or
// remounted since is among them.
[[nodiscard]] Result<std::vector<EdgeId>> LoadIdsWithin(Store& store, const RobotId& robot, const MergedEdge& merged);

// What people said of a robot's edges that matters for what was merged.
struct WhatCounts {
  std::map<SessionId, Superseding> superseded;
  std::map<EdgeId, Standing> retired;
  std::vector<Epoch> epochs;
  std::map<SessionId, Standing> retired_sessions = {};
  std::map<SensorId, Standing> retired_sensors = {};
};
// Several readings: call it inside one Read, so that all are of one moment.
[[nodiscard]] Result<WhatCounts> LoadWhatCounts(Store& store, const RobotId& robot);
// True: of what has left the window an edge, session or sensor was retired or restored, a session superseded, or an
// epoch of a sensor begun, after the newest revision. Then the merged edges hold no more, and all edges of the robot
// count as they are until the next revision merges anew.
[[nodiscard]] Result<bool> IsMergeOutdated(Store& store, const RobotId& robot, const WhatCounts& counts);

// Whether they are to be made from all edges of the robot where nothing else says so: an older version made them
// otherwise, or `visits_in_full` (policy.h) are more than stayed as they are in the newest revision.
[[nodiscard]] Result<bool> IsToMergeAnew(Store& store, const RobotId& robot, std::int64_t visits_in_full);
// Robots whose merged edges an older version made otherwise, and no revision has made anew yet.
[[nodiscard]] Result<std::int64_t> CountToMergeAnew(Store& store);

struct MergeStep {
  std::vector<MergedEdge> merged;
  std::vector<EdgeId> taken;     // are in merged edges from now on, or past
  std::vector<EdgeId> back;      // were, and are in none: all edges that there are, where merging began anew
  std::vector<EdgeId> ids = {};  // that the merged ones have in the revision
  bool anew = false;             // made of all edges, with nothing of what was merged before
  bool never_anew = false;       // that was given up: they stay as an older version made them
  std::int64_t visits_in_full = kDefaultVisitsInFull;
};
// Call inside the Write that appends the revision. `counts`: as the revision saw it.
[[nodiscard]] Status AppendMergedEdges(Store& store, const RevisionKey& key, const MergeStep& step,
                                       const WhatCounts& counts);

}  // namespace rigcal::storage
