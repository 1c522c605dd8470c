// One line of the log, and one count, per edge and per revision that the pipeline makes.
#pragma once

#include "server/model/edges/edge.h"
#include "server/model/graph/graph.h"

namespace rigcal::pipeline {

// Of a pair of a session; a failed one says why.
void LogEdge(const Edge& edge);
// With its verdict.
void LogRevision(const Revision& revision);

}  // namespace rigcal::pipeline
