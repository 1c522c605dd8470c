// Which sensor was moved during a session, as its pairs tell one by one: of sensors that no joint refinement looked at.
#pragma once

#include <vector>

#include "server/model/edges/edge.h"
#include "server/model/sessions/session_estimate.h"

namespace rigcal::pipeline {

// Of the session's good edges with block vectors: adds to `moved` and `by_pairs` of its estimate. Where changes of
// several pairs that fall into the same captures have one sensor in common, that one was moved; else either of two.
// Where the session was refined: of pairs with a sensor that took no part. One that did, and would have been told of
// such a step there, is cleared; a pair of a sensor that is told says nothing of the other. `captures`: of the session.
void AddMovesOfPairs(const std::vector<Edge>& edges, const std::vector<CaptureId>& captures, SessionEstimate& estimate);

}  // namespace rigcal::pipeline
