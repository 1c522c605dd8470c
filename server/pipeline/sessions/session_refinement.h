// READ, joint refinement, WRITE: one estimate per session from the raw observations that its pairs were made from.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "server/base/stamp.h"
#include "server/calib/camera/camera_memory.h"
#include "server/model/boards/square_size.h"
#include "server/model/edges/edge.h"
#include "server/model/sessions/session_estimate.h"
#include "server/pipeline/sessions/current_edges.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// Of a robot's sessions that count (neither superseded nor retired) so many are refined and fused, the newest captured:
// what is older says little of where sensors are now. Which these are does not depend on the order in which they came,
// nor on when revisions were made between them.
constexpr int kSessionsFused = 32;
// Of stored estimates; raised when the same observations give another estimate.
inline constexpr const char* kSessionEstimator = "joint/21";

// Makes and commits what is missing of the newest kSessionsFused whose jobs are done: of a visit one, of visits that
// came all at once, and after a newer version of the estimator, all. A session that cannot be refined gets
// an estimate that says why; one that failed for a reason of ours (no memory) gets none and is tried at the next
// revision.
[[nodiscard]] Status RefineSessions(storage::Store& store, const RobotId& robot, calib::CameraMemory& cameras,
                                    const Clock& clock);

// READ: the estimate of one stored session with `sizes` in the place of those that it states. Nothing where its pairs
// are not there (some are still to be calibrated, wait for files, or there are none). kStorage where the disk has not
// kept a file; kInternal where it failed for a reason of ours.
[[nodiscard]] Result<std::optional<SessionEstimate>> EstimateStored(storage::Store& store, const SessionId& session,
                                                                    const SquareSizes& sizes,
                                                                    calib::CameraMemory& cameras);

struct CurrentEstimates {
  std::vector<SessionEstimate> estimates;
  std::vector<Edge> within;  // what of their edges is in merged ones (current_edges.h)
};
// Of sessions that count (not superseded, not retired), the newest captured first. Moves of sensors that were remounted
// since, or of which no edge of the session counts any more, are left out, and so is what could have moved unseen of
// retired ones. `run`: of the candidate of that re-computation (session_estimates.h). Call within one Read, with
// `current`.
[[nodiscard]] Result<CurrentEstimates> LoadCurrentEstimates(storage::Store& store, const RobotId& robot,
                                                            const CurrentEdges& current, std::int64_t run = 0);

// Sensors of which a good edge of the session still says something.
using SessionSensors = std::set<std::pair<SessionId, SensorId>>;
[[nodiscard]] SessionSensors SensorsThatCount(const CurrentEdges& current, const std::vector<Edge>& within);

}  // namespace rigcal::pipeline
