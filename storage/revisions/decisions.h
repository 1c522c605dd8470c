// Which revisions were approved, rejected, rolled back to. Append-only. What the robot is to use follows: of the
// revisions that were approved or rolled back to, and neither rejected since nor rolled back behind (the robot was
// rolled back to an older one since), the one that was decided last; none where that one is usable no more
// (LoadUsableRevision). Whoever rejects a revision rejects all that have its document.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>

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

// That by which a revision is in use; nothing: none is. Whether it may still be used: LoadUsableRevision.
[[nodiscard]] Result<std::optional<Decision>> LoadInUse(Store& store, const RobotId& robot);
// The newest revision that was ever approved, also where it is used no more; 0: there is none.
[[nodiscard]] Result<int> LoadNewestApproved(Store& store, const RobotId& robot);

// Whether the robot was ever to use it.
[[nodiscard]] Result<bool> WasApproved(Store& store, const RobotId& robot, int revision);
// Whether anything was ever decided about it by this person and for this very reason.
[[nodiscard]] Result<bool> WasDecidedBecause(Store& store, const RobotId& robot, int revision, const std::string& who,
                                             const std::string& reason);
// Documents that are rejected: nobody said another thing since of the revision that was. The newest first.
struct RejectedDocument {
  Digest digest;
  Word word;
};
[[nodiscard]] Result<std::vector<RejectedDocument>> LoadRejections(Store& store, const RobotId& robot,
                                                                   std::int64_t limit);
// The newest about this revision, or after that the rejection of one with the same document; nothing: nobody decided.
[[nodiscard]] Result<std::optional<Decision>> LoadDecision(Store& store, const RobotId& robot, int revision);
// `usable`: what its robot is to use (pipeline/robots/validity.h).
[[nodiscard]] Result<RevisionState> LoadRevisionState(Store& store, const Revision& revision,
                                                      const std::optional<UsableRevision>& usable);

// That which is in use, if it may be used, without its document. Nothing where it counts an edge that was retired
// since, itself or with its session: then none is in use, until somebody decides.
[[nodiscard]] Result<std::optional<Revision>> LoadUsableRevision(Store& store, const RobotId& robot);
// Of the revisions that were to be used and neither rejected nor rolled back behind since, the one that was decided
// last and counts nothing that was retired since; without its document. `up_to`: among those with numbers up to this
// one. `decided_by`: by what was decided until then, this time included; what was decided later changes nothing.
[[nodiscard]] Result<std::optional<Revision>> LoadStillUsable(Store& store, const RobotId& robot,
                                                              int up_to = std::numeric_limits<int>::max(),
                                                              Stamp decided_by = Stamp{
                                                                  std::numeric_limits<std::int64_t>::max()});
// Whether a person's no keeps the policy from putting a revision with this document in use: a revision of this very
// document is rejected, or no edge of the robot began to count since its newest rejection or rollback.
// `edge_watermark`: the newest edge that is known to whoever asks.
[[nodiscard]] Result<bool> IsHeldBack(Store& store, const RobotId& robot, const Digest& digest,
                                      std::int64_t edge_watermark);

}  // namespace rigcal::storage
