// Which revision may be used, of what was decided, and what a person's no keeps the policy from.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "server/model/graph/graph.h"
#include "storage/store.h"

namespace rigcal::storage {

// That which is in use (decisions.h), without its document. Nothing where it counts an edge that was retired since,
// itself or with its session: then none is in use, until somebody decides.
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
