// Which edges of a robot its revisions take as they are, and the merged edges that stand for the others (model/merged_edge.h).
#pragma once

#include <vector>

#include "server/model/merged_edge.h"
#include "storage/revisions.h"

namespace rigcal::storage {

// Of a revision, or of the newest (`number` 0); by frames and method.
[[nodiscard]] Result<std::vector<MergedEdge>> LoadMergedEdges(Store& store, const RobotId& robot, int number = 0);
// True: an edge was retired that is in a merged edge. Then the merged edges hold no more, and all edges of the robot count as
// they are until the next revision merges anew.
[[nodiscard]] Result<bool> IsMergeOutdated(Store& store, const RobotId& robot);
// Call inside the Write that appends the revision. `taken` are in merged edges from now on; `back` were, and are in none.
[[nodiscard]] Status AppendMergedEdges(Store& store, const RevisionKey& key, const std::vector<MergedEdge>& merged,
                                       const std::vector<EdgeId>& taken, const std::vector<EdgeId>& back);

}  // namespace rigcal::storage
