// The poses of each revision with their joint covariance, of whole poses and of those that are known in part
// (server/model/graph/joint_poses.h).
#pragma once

#include <optional>

#include "server/model/graph/joint_poses.h"
#include "storage/revisions/revisions.h"

namespace rigcal::storage {

// Call inside Write, after AppendRevision.
[[nodiscard]] Status AppendRevisionPoses(Store& store, const RevisionKey& key, const JointPoses& poses);
// Nothing of a revision without known poses, or from before schema version 12.
[[nodiscard]] Result<std::optional<JointPoses>> LoadRevisionPoses(Store& store, const RevisionKey& key);

// Where the revision put its sensors, if any is known in part only. Call inside Write, after AppendRevision.
[[nodiscard]] Status AppendPlacedPoses(Store& store, const RevisionKey& key, const PlacedPoses& poses);
// Nothing of a revision without such a sensor, or from before revisions kept it (0056_placed_poses.sql). kStorage: what
// is stored is damaged.
[[nodiscard]] Result<std::optional<PlacedPoses>> LoadPlacedPoses(Store& store, const RevisionKey& key);

}  // namespace rigcal::storage
