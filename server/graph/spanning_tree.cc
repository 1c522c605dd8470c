#include "server/graph/spanning_tree.h"

#include <algorithm>
#include <tuple>

#include "server/graph/union_find.h"

namespace rigcal::graph {
namespace {

// Constraints from the most to the least certain. 1/2 log det C = -1/2 log det Omega.
std::vector<std::size_t> ByCertainty(const Problem& problem) {
  std::vector<std::tuple<int, double, std::size_t>> keys(problem.constraints.size());
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const Constraint& c = problem.constraints[k];
    keys[k] = {-c.rank, c.rank == 6 ? -c.log_det_Omega : 0.0, k};
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::size_t> order(keys.size());
  for (std::size_t k = 0; k < keys.size(); ++k) order[k] = std::get<2>(keys[k]);
  return order;
}

// The tree's edges by vertex. Placed vertices count as one.
std::vector<std::vector<std::size_t>> TreeEdges(const Problem& problem, const std::vector<bool>& placed) {
  const auto count = static_cast<std::size_t>(problem.vertex_count);
  UnionFind sets(count);
  for (std::size_t v = 1; v < count; ++v)
    if (placed[v]) sets.Join(0, static_cast<int>(v));
  std::vector<std::vector<std::size_t>> edges_at(count);
  for (const std::size_t k : ByCertainty(problem)) {
    const Constraint& c = problem.constraints[k];
    if (!sets.Join(c.i, c.j)) continue;
    edges_at[static_cast<std::size_t>(c.i)].push_back(k);
    edges_at[static_cast<std::size_t>(c.j)].push_back(k);
  }
  return edges_at;
}

}  // namespace

Poses GrowTree(const Problem& problem, Poses T_ref, std::vector<bool> placed) {
  placed[0] = true;
  const auto edges_at = TreeEdges(problem, placed);
  std::vector<std::size_t> queue;
  for (std::size_t v = 0; v < placed.size(); ++v)
    if (placed[v]) queue.push_back(v);
  for (std::size_t at = 0; at < queue.size(); ++at) {
    const std::size_t v = queue[at];
    for (const std::size_t k : edges_at[v]) {
      const Constraint& c = problem.constraints[k];
      const bool forward = static_cast<std::size_t>(c.i) == v;
      const auto other = static_cast<std::size_t>(forward ? c.j : c.i);
      if (placed[other]) continue;
      T_ref[other] = (T_ref[v] * (forward ? c.T_i_j : c.T_j_i)).Normalized();
      placed[other] = true;
      queue.push_back(other);
    }
  }
  return T_ref;
}

Poses SpanningTreePoses(const Problem& problem) {
  const auto count = static_cast<std::size_t>(problem.vertex_count);
  return GrowTree(problem, Poses(count), std::vector<bool>(count, false));
}

}  // namespace rigcal::graph
