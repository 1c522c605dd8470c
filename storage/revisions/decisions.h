// Which revisions were approved, rejected, rolled back to. Append-only. What the robot is to use follows: of the
// revisions that were approved or rolled back to, and neither rejected since nor rolled back behind (the robot was
// rolled back to an older one since), the one that was decided last; none where that one is usable no more
// (usable_revision.h).
#pragma once

#include <optional>

#include "server/model/approval/decision.h"
#include "server/model/approval/validity.h"
#include "server/model/graph/graph.h"
#include "storage/store.h"

namespace rigcal::storage {

enum class Deciding { kApprove, kReject, kRollBack };

// Noted in the audit. False, and a no-op, where it is so already: then the first word holds. kNotFound without such a
// revision; kConflict where it is to be used and its verdict is neither pass nor warn, or where the robot is to be
// rolled back to what was never approved, or rejected since; kInvalidInput for a word that is none (standing.h).
[[nodiscard]] Result<bool> AppendDecision(Store& store, const RobotId& robot, int revision, Deciding deciding,
                                          const Word& word);

// That by which a revision is in use; nothing: none is. Whether it may still be used: usable_revision.h.
[[nodiscard]] Result<std::optional<Decision>> LoadInUse(Store& store, const RobotId& robot);
// The newest revision that was ever approved, also where it is used no more; 0: there is none.
[[nodiscard]] Result<int> LoadNewestApproved(Store& store, const RobotId& robot);

// Whether the robot was ever to use it.
[[nodiscard]] Result<bool> WasApproved(Store& store, const RobotId& robot, int revision);
// The newest about this revision; nothing: nobody decided.
[[nodiscard]] Result<std::optional<Decision>> LoadDecision(Store& store, const RobotId& robot, int revision);
// `usable`: what its robot is to use (pipeline/robots/validity.h).
[[nodiscard]] Result<RevisionState> LoadRevisionState(Store& store, const Revision& revision,
                                                      const std::optional<UsableRevision>& usable);

}  // namespace rigcal::storage
