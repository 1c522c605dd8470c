// The poses of each revision with their joint covariance (server/model/graph/joint_poses.h).
#pragma once

#include <optional>

#include "server/model/graph/joint_poses.h"
#include "storage/revisions/revisions.h"

namespace rigcal::storage {

// Call inside Write, after AppendRevision.
[[nodiscard]] Status AppendRevisionPoses(Store& store, const RevisionKey& key, const JointPoses& poses);
// Nothing of a revision without known poses, or from before schema version 12.
[[nodiscard]] Result<std::optional<JointPoses>> LoadRevisionPoses(Store& store, const RevisionKey& key);

}  // namespace rigcal::storage
