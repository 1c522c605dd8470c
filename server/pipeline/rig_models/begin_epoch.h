// The order that begins an epoch of sensors by hand, or takes it back.
#pragma once

#include "server/base/stamp.h"
#include "server/formats/answers/parameters.h"
#include "server/model/approval/order.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// Order epoch: `robot`, `sensors` (names with commas between them; none: all of the robot), `who`, `reason`, `at` (when
// it began, as ISO; none: now). What was measured of them before is past from now on. `take_back`: the newest epoch
// that a person began of each of them is as if it was never said; kNotFound where there is none. Said twice within a
// minute without `at` it was said once.
[[nodiscard]] Result<OrderDone> BeginEpochBy(storage::Store& store, const Clock& clock,
                                             const formats::Parameters& parameters);

}  // namespace rigcal::pipeline
