// Which sensor of a session that is not refined as a whole was moved meanwhile, as its pairs tell one by one.
#pragma once

#include <vector>

#include "server/model/edges/edge.h"
#include "server/model/sessions/session_estimate.h"

namespace rigcal::pipeline {

// Of the session's good edges with block vectors: fills `moved` and `by_pairs` of its estimate. Where changes of
// several pairs that fall into the same captures have one sensor in common, that one was moved; else either of two.
// `captures`: of the session.
void AddMovesOfPairs(const std::vector<Edge>& edges, const std::vector<CaptureId>& captures, SessionEstimate& estimate);

}  // namespace rigcal::pipeline
