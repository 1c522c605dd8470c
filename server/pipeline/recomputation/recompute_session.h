// READ, joint refinement, WRITE: one stored session of a re-computation.
#pragma once

#include "server/base/stamp.h"
#include "server/calib/camera/camera_memory.h"
#include "storage/store.h"
#include "storage/work/recomputations.h"

namespace rigcal::pipeline {

// Its estimate by the estimator of today with the sizes that the run says, committed together with the end of the item.
// One that is there already stays. What cannot be computed (files that the disk has not kept, pairs that never came) is
// kept as it is, and says why; lost files are asked for by the next push of the session. An error is the store's or
// ours: the item still waits.
[[nodiscard]] Status RecomputeSession(storage::Store& store, const storage::RecomputationItem& item, const Clock& clock,
                                      calib::CameraMemory& cameras);

}  // namespace rigcal::pipeline
