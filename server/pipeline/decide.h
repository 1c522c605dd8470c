// Who lets a revision be used: the policy, in the transaction that makes the revision, or a person, by an order.
#pragma once

#include <vector>

#include "server/base/stamp.h"
#include "server/formats/parameters.h"
#include "server/model/decision.h"
#include "server/model/graph.h"
#include "server/model/order.h"
#include "server/model/robot_runs.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// WRITE: inside the Write that appended the revision: it is approved or left a candidate by the policy that holds then,
// once for all, whatever ends the process. `found_drift` as in Approves (model/decision.h).
[[nodiscard]] Status ApproveByPolicy(storage::Store& store, const Revision& revision, bool found_drift, Stamp now);

// Orders approve, reject (`revision`: the newest without it) and rollback (`revision` is needed); `robot`, `who`,
// `reason`. One transaction; kConflict where the robot could not use the revision after all, because of what was
// retired or moved since.
[[nodiscard]] Result<OrderDone> Decide(storage::Store& store, const Clock& clock, const std::string& verb,
                                       const formats::Parameters& parameters);

// READ: where a revision is in its life, and which one its robot is to use.
[[nodiscard]] Result<Approval> LoadApproval(storage::Store& store, const Revision& revision);
// Of several of one robot, in their order.
[[nodiscard]] Result<std::vector<Approval>> LoadApprovals(storage::Store& store, const RobotId& robot,
                                                          const std::vector<Revision>& revisions);
// READ: what the robot says that it runs, beside what is in use; nothing: it never told.
[[nodiscard]] Result<std::optional<Runs>> LoadWhatRuns(storage::Store& store, const RobotId& robot);
// Of what robots use by default: the revision that is in use. Where none is, the newest, if nobody could approve it;
// else kConflict.
[[nodiscard]] Result<Revision> LoadRevisionInUse(storage::Store& store, const RobotId& robot);

}  // namespace rigcal::pipeline
