// PURE: whether a robot's graph stands without the sensor that was its reference.
#pragma once

#include "server/base/result.h"
#include "server/model/graph/graph.h"

namespace rigcal::pipeline {

// `before` and `after`: the graph with the sensor and without it, each with its own reference. kConflict, with what to
// do first, where no good edge is left, or a sensor that good edges tied to the old reference is not tied to the new
// one by any.
[[nodiscard]] Status CheckNextReference(const Graph& before, const Graph& after);

}  // namespace rigcal::pipeline
