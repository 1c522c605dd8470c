// Weak edges beside better ones. A weak edge (model/edges/weak_edge.h) takes no part where a path of better ones,
// measured at the same time or later, holds both of its sensors. What nothing better was measured after it says counts:
// it may be the only sign that a sensor was moved.
#pragma once

#include <map>
#include <set>
#include <vector>

#include "server/base/stamp.h"
#include "server/model/edges/edge.h"

namespace rigcal::graph {

// Which of the good edges take no part (a pushed one that tells no date was measured when it came). Better: all six
// directions, from a covariance that was not assumed. Edges without a date are taken as of one time, before all others.
// For any order of `edges`.
[[nodiscard]] std::set<EdgeId> WeakBesideBetter(const std::vector<Edge>& edges,
                                                const std::map<EdgeId, Stamp>& measured_at = {});
// `edges` without these.
[[nodiscard]] std::vector<Edge> WithoutEdges(std::vector<Edge> edges, const std::set<EdgeId>& without);

}  // namespace rigcal::graph
