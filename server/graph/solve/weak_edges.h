// Weak edges beside better ones. A weak edge (model/edges/weak_edge.h) counts where nothing better ties its sensors,
// and takes no part where a path of better edges, which see all six directions, holds both of them.
#pragma once

#include <set>
#include <vector>

#include "server/model/edges/edge.h"

namespace rigcal::graph {

// Which of the good edges take no part. For any order of `edges`.
[[nodiscard]] std::set<EdgeId> WeakBesideBetter(const std::vector<Edge>& edges);

}  // namespace rigcal::graph
