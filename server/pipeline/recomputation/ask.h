// Re-computations of stored sessions: the order that asks for one, and what came of it.
#pragma once

#include <string>

#include "server/base/stamp.h"
#include "server/formats/answers/parameters.h"
#include "server/model/approval/order.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// Order resolve: one of `all` (true), `model`, `robot`, `board` (a serial), and `who`. The robots of that scope that
// have a revision, and of each the sessions that count among its newest kSessionsFused, the oldest first: what is older
// says nothing of a calibration. `board`: the robots that it was shown to, and in the sessions that name it the size
// that was measured last takes the place of theirs, where kind and counts agree. Other sessions keep the sizes that an
// approved run gave them. Asked twice it is one run (storage/work/recomputations.h). kNotFound: no such robot, model or
// board, one that nobody measured, or nothing to compute.
[[nodiscard]] Result<OrderDone> AskToRecompute(storage::Store& store, const Clock& clock,
                                               const formats::Parameters& parameters);

// READ: what came of a re-computation, and how far it is. Verb recomputation: `run` (its number; else the newest),
// `limit` (0 to 1000 robots, and sessions that were left; else 100). kNotFound where there is no such run.
[[nodiscard]] Result<std::string> TellRecomputation(storage::Store& store, const formats::Parameters& parameters);

}  // namespace rigcal::pipeline
