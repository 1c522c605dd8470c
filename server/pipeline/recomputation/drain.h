// The next piece of the re-computations that people asked for.
#pragma once

#include "server/base/stamp.h"
#include "server/calib/camera/camera_memory.h"
#include "server/pipeline/step.h"
#include "storage/store.h"
#include "storage/work/recomputations.h"

namespace rigcal::pipeline {

// One stored session, or a robot whose sessions are done, of a robot that nobody works on; one at a time in all
// threads, so that what is pushed meanwhile finds another thread free. For when there is nothing else to do. What
// failed kAttemptsMax times is noted as failed and passed over. Not worked: there is nothing, or somebody else does it.
[[nodiscard]] Result<StepResult> RecomputeNext(const StepContext& context);

// READ, joint refinement, WRITE: one stored session of a re-computation. Its estimate by the estimator of today with
// the sizes that the run says, committed together with the end of the item. One that is there already stays. What
// cannot be computed (files that the disk has not kept, pairs that never came) is kept as it is, and says why; lost
// files are asked for by the next push of the session. An error is the store's or ours: the item still waits.
[[nodiscard]] Status RecomputeSession(storage::Store& store, const storage::RecomputationItem& item, const Clock& clock,
                                      calib::CameraMemory& cameras);

}  // namespace rigcal::pipeline
