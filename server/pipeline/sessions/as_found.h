// READ: what the newest session of a robot found of the calibration that was in use when it came.
#pragma once

#include <optional>

#include "server/fleet/assess.h"
#include "server/formats/documents.h"
#include "server/model/sessions/as_found.h"
#include "server/pipeline/sessions/current_edges.h"
#include "server/pipeline/sessions/session_refinement.h"

namespace rigcal::pipeline {

// What a revision is made of, and what it says.
struct RevisionInTheMaking {
  const CurrentEdges& current;
  const CurrentEstimates& refined;
  const fleet::SessionTimes& captured_at;
  std::int64_t watermark;  // of its edges
  const formats::RevisionInput& made;
  const Policy& policy;
};
// In use is what the robot was to use by what was decided (decisions.h) until the first revision with the session
// was made, among the revisions that have nothing of the session, nor of one of the same pictures that it supersedes;
// so it is the same however often a revision of the same sessions is made and whatever is decided later, until somebody
// retires. Also where a sensor was moved on purpose since: that
// is told of the sensor. Where the calibration in use tells no scatter of a sensor, that of other robots is taken by
// which the revision is fused. Nothing where no session was refined.
[[nodiscard]] Result<std::optional<AsFound>> FindAsFound(storage::Store& store, const RevisionInTheMaking& revision);

}  // namespace rigcal::pipeline
