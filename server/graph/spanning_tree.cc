#include "server/graph/spanning_tree.h"

#include <algorithm>
#include <tuple>
#include <utility>

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

// The tree's edges at each vertex, as lists through arrays: entry 2 k is constraint k at its i, 2 k + 1 at its j.
struct TreeEdges {
  static constexpr std::size_t kEnd = static_cast<std::size_t>(-1);
  std::vector<std::size_t> first, next;  // by vertex, by entry

  TreeEdges(std::size_t vertices, std::size_t constraints) : first(vertices, kEnd), next(2 * constraints, kEnd) {}
  void Add(int vertex, std::size_t entry) {
    next[entry] = std::exchange(first[static_cast<std::size_t>(vertex)], entry);
  }
};

// Placed vertices count as one.
TreeEdges FindTree(const Problem& problem, const std::vector<bool>& placed) {
  const auto count = static_cast<std::size_t>(problem.vertex_count);
  UnionFind sets(count);
  for (std::size_t v = 1; v < count; ++v)
    if (placed[v]) sets.Join(0, static_cast<int>(v));
  TreeEdges tree(count, problem.constraints.size());
  for (const std::size_t k : ByCertainty(problem)) {
    const Constraint& c = problem.constraints[k];
    if (!sets.Join(c.i, c.j)) continue;
    tree.Add(c.i, 2 * k);
    tree.Add(c.j, 2 * k + 1);
  }
  return tree;
}

}  // namespace

Poses GrowTree(const Problem& problem, Poses T_ref, std::vector<bool> placed) {
  placed[0] = true;
  const TreeEdges tree = FindTree(problem, placed);
  std::vector<std::size_t> queue;
  queue.reserve(placed.size());
  for (std::size_t v = 0; v < placed.size(); ++v)
    if (placed[v]) queue.push_back(v);
  for (std::size_t at = 0; at < queue.size(); ++at) {
    const std::size_t v = queue[at];
    for (std::size_t entry = tree.first[v]; entry != TreeEdges::kEnd; entry = tree.next[entry]) {
      const Constraint& c = problem.constraints[entry / 2];
      const bool forward = entry % 2 == 0;
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
