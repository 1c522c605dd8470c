// Which revisions were approved, rejected, rolled back to. Append-only. What the robot is to use follows: of the
// revisions that were approved or rolled back to, and neither rejected since nor rolled back behind (the robot was
// rolled back to an older one since), the one that was decided last.
#pragma once

#include <limits>
#include <optional>

#include "server/model/decision.h"
#include "server/model/graph.h"
#include "storage/store.h"

namespace rigcal::storage {

enum class Deciding { kApprove, kReject, kRollBack };

// Noted in the audit. False, and a no-op, where it is so already: then the first word holds. kNotFound without such a
// revision; kConflict where it is to be used and its verdict is neither pass nor warn, or where the robot is to be
// rolled back to what was never approved; kInvalidInput for a word that is none (standing.h).
[[nodiscard]] Result<bool> AppendDecision(Store& store, const RobotId& robot, int revision, Deciding deciding,
                                          const Word& word);

// That by which a revision is in use; nothing: none is. Whether it may still be used: LoadUsableRevision.
[[nodiscard]] Result<std::optional<Decision>> LoadInUse(Store& store, const RobotId& robot);
// The revision that is in use, or was before it, and counts no edge which was retired since, itself or with its
// session; without the document. `up_to`: the same among those with numbers up to this one. `decided_by`: by what was
// decided until then, this time included; what was decided later, as of an older revision, changes nothing.
[[nodiscard]] Result<std::optional<Revision>> LoadUsableRevision(
    Store& store, const RobotId& robot, int up_to = std::numeric_limits<int>::max(),
    Stamp decided_by = Stamp{std::numeric_limits<std::int64_t>::max()});
// The newest revision that was ever approved, also where it is used no more; 0: there is none.
[[nodiscard]] Result<int> LoadNewestApproved(Store& store, const RobotId& robot);

// Whether the robot was ever to use it.
[[nodiscard]] Result<bool> WasApproved(Store& store, const RobotId& robot, int revision);
// The newest about this revision; nothing: nobody decided.
[[nodiscard]] Result<std::optional<Decision>> LoadDecision(Store& store, const RobotId& robot, int revision);
[[nodiscard]] Result<RevisionState> LoadRevisionState(Store& store, const Revision& revision);

}  // namespace rigcal::storage
