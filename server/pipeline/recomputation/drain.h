// The next piece of the re-computations that people asked for.
#pragma once

#include "server/pipeline/step.h"

namespace rigcal::pipeline {

// One stored session, or a robot whose sessions are done, of a robot that nobody works on; one at a time in all
// threads, so that what is pushed meanwhile finds another thread free. For when there is nothing else to do. What
// failed kAttemptsMax times is noted as failed and passed over. Not worked: there is nothing, or somebody else does it.
[[nodiscard]] Result<StepResult> RecomputeNext(const StepContext& context);

}  // namespace rigcal::pipeline
