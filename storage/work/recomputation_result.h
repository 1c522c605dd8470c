// READ: how far re-computations are, what came of them, and which candidates wait for a person because of them.
#pragma once

#include <optional>
#include <vector>

#include "server/model/sessions/recomputation.h"
#include "storage/revisions/revisions.h"
#include "storage/store.h"

namespace rigcal::storage {

// By its number, or the newest of all for 0; nothing: there is none.
[[nodiscard]] Result<std::optional<RecomputationRun>> LoadRecomputation(Store& store, std::int64_t run);
[[nodiscard]] Result<RecomputationProgress> LoadRecomputationProgress(Store& store, std::int64_t run);
// Those that are done, at most `limit`: what changed most by sigmas first, then what failed, then what is unchanged; by
// id.
[[nodiscard]] Result<std::vector<RecomputedRobot>> LoadRecomputedRobots(Store& store, std::int64_t run,
                                                                        std::int64_t limit);
// Sessions that were kept or failed, by robot and session, at most `limit`.
[[nodiscard]] Result<std::vector<SessionLeft>> LoadSessionsLeft(Store& store, std::int64_t run, std::int64_t limit);

// By which run a revision came; nothing: by none.
[[nodiscard]] Result<std::optional<RecomputationRun>> LoadCauseOf(Store& store, const RevisionKey& key);
// Whether a re-computed candidate of the robot, `number` or one before it, keeps the policy from approving that
// revision: no person decided about it or a later one, and no edge of the robot began to count since. `edge_watermark`
// as in IsHeldBack.
[[nodiscard]] Result<bool> AwaitsPerson(Store& store, const RobotId& robot, int number, std::int64_t edge_watermark);

}  // namespace rigcal::storage
