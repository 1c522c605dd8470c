// What each revision says of the status of its robot, sensor by sensor (robots/robot_status.h), and which visits of
// which rig model found something of the calibration in use.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/model/robots/robot_status.h"
#include "storage/revisions/revisions.h"

namespace rigcal::storage {

// Call inside Write, after AppendRevision.
[[nodiscard]] Status AppendRevisionStatus(Store& store, const RevisionKey& key, const StatusFacts& facts);
// Nothing of a revision that waited for pairs, or from before it was kept.
[[nodiscard]] Result<std::optional<StatusFacts>> LoadRevisionStatus(Store& store, const RevisionKey& key);

// That the revision is the first with what `session` found; a no-op where an earlier one is. Call inside Write.
[[nodiscard]] Status AppendModelVisit(Store& store, const std::string& rig_model, const RevisionKey& key,
                                      const SessionId& session);
[[nodiscard]] Result<bool> HasModelVisit(Store& store, const RobotId& robot, const SessionId& session);
// Of a rig model, of those whose session is neither superseded nor retired now the newest `max` in the order of
// arrival; of `robot` alone if it is not empty, of whatever model.
[[nodiscard]] Result<std::vector<RevisionKey>> LoadModelVisits(Store& store, const std::string& rig_model,
                                                               const RobotId& robot, int max);

}  // namespace rigcal::storage
