// Who lets a revision be used: the policy, in the transaction that makes the revision, or a person, by an order.
#pragma once

#include <vector>

#include "server/base/stamp.h"
#include "server/formats/answers/parameters.h"
#include "server/model/approval/decision.h"
#include "server/model/approval/order.h"
#include "server/model/graph/graph.h"
#include "server/model/robots/robot_runs.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// WRITE: inside the Write that appended the revision: it is approved or left a candidate by the policy that holds then,
// once for all, whatever ends the process. A candidate it stays, too, where a person's no holds the policy back
// (storage/revisions/decisions.h), where a re-computed candidate waits for a person (recomputation_result.h),
// and where the audit can take no row. `found_drift` as in Approves (model/approval/decision.h).
[[nodiscard]] Status ApproveByPolicy(storage::Store& store, const Revision& revision, bool found_drift, Stamp now);

// WRITE: inside the Write that retired something. Where that was of the revision in use, the one before it is in use by
// the policy, if it approves by itself; else none is, until somebody decides.
[[nodiscard]] Status FallBackByPolicy(storage::Store& store, const RobotId& robot, Stamp now);

// Orders approve, reject and rollback: `robot`, `revision`, `who`, `reason`. One transaction; kInvalidInput without a
// revision names the one that may be meant; kConflict where the robot could not use the revision after all, because of
// what was retired or moved since.
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
