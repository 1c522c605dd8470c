// The lenses that belong to a revision's poses.
#pragma once

#include <map>
#include <vector>

#include "server/formats/documents.h"
#include "server/model/sensors/refined_lens.h"
#include "server/report/cameras/camera_choice.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// READ. Each camera gets the lens that the newest session behind its pose in `revision` was refined with: of those that
// were fused the newest of which a good edge of the camera counts. Where that held its lens, it keeps what its own
// pictures say; so it does in documents of before (without FusedSessions::made_by) where that session is none of the
// newest 32, or was refined anew since.
[[nodiscard]] Status TakeRefinedLenses(storage::Store& store, const formats::RevisionInput& revision,
                                       std::vector<report::CameraReport>& cameras);
// READ. What each of these sessions by itself was refined with; of those that refined none nothing.
[[nodiscard]] Result<std::map<SessionId, std::vector<RefinedLens>>> LoadRefinedLenses(
    storage::Store& store, const formats::RevisionInput& revision);

}  // namespace rigcal::pipeline
