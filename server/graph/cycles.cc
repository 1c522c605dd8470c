#include "server/graph/cycles.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <set>

#include "server/graph/problem.h"
#include "server/math/covariance.h"

namespace rigcal::graph {
namespace {

struct Step {
  std::size_t constraint = 0;
  bool forward = true;  // from i to j
};
using Walk = std::vector<Step>;

struct Tree {
  std::vector<int> depth;       // by vertex
  std::vector<Step> to_parent;  // the step from a vertex to its parent
  std::vector<bool> in_tree;    // by constraint
};

std::vector<std::vector<std::size_t>> ConstraintsAt(const Problem& problem) {
  std::vector<std::vector<std::size_t>> at(static_cast<std::size_t>(problem.vertex_count));
  for (std::size_t k = 0; k < problem.constraints.size(); ++k) {
    at[static_cast<std::size_t>(problem.constraints[k].i)].push_back(k);
    at[static_cast<std::size_t>(problem.constraints[k].j)].push_back(k);
  }
  return at;
}

Tree GrowBreadthFirst(const Problem& problem, const std::vector<std::vector<std::size_t>>& at) {
  const auto count = static_cast<std::size_t>(problem.vertex_count);
  Tree tree{std::vector<int>(count, -1), std::vector<Step>(count),
            std::vector<bool>(problem.constraints.size(), false)};
  std::vector<std::size_t> queue = {0};
  tree.depth[0] = 0;
  for (std::size_t n = 0; n < queue.size(); ++n)
    for (const std::size_t k : at[queue[n]]) {
      const Constraint& c = problem.constraints[k];
      const bool is_i = static_cast<std::size_t>(c.i) == queue[n];
      const auto other = static_cast<std::size_t>(is_i ? c.j : c.i);
      if (tree.depth[other] >= 0) continue;
      tree.depth[other] = tree.depth[queue[n]] + 1;
      tree.to_parent[other] = {k, !is_i};
      tree.in_tree[k] = true;
      queue.push_back(other);
    }
  return tree;
}

int End(const Problem& problem, const Step& step) {
  const Constraint& c = problem.constraints[step.constraint];
  return step.forward ? c.j : c.i;
}

// From i over the edge to j, up to the common ancestor and down again to i.
Walk LoopOf(const Problem& problem, const Tree& tree, std::size_t chord) {
  Walk walk = {{chord, true}}, down;
  int a = problem.constraints[chord].j, b = problem.constraints[chord].i;
  const auto depth = [&tree](int vertex) { return tree.depth[static_cast<std::size_t>(vertex)]; };
  while (a != b) {
    int& deeper = depth(a) >= depth(b) ? a : b;
    const Step step = tree.to_parent[static_cast<std::size_t>(deeper)];
    if (&deeper == &a) {
      walk.push_back(step);
    } else {
      down.push_back({step.constraint, !step.forward});
    }
    deeper = End(problem, step);
  }
  walk.insert(walk.end(), down.rbegin(), down.rend());
  return walk;
}

CycleResidual Compose(const Graph& graph, const Problem& problem, const Walk& walk) {
  CycleResidual cycle;
  cycle.tested = true;
  Se3 T;
  Matrix6d C = Matrix6d::Zero();
  for (const Step& step : walk) {
    const Constraint& c = problem.constraints[step.constraint];
    cycle.edges.push_back(graph.edges[problem.edges_by_id[c.edge]].id);
    cycle.sensors.push_back(
        graph.sensors[problem.sensor_of_vertex[static_cast<std::size_t>(step.forward ? c.i : c.j)]]);
    cycle.tested = cycle.tested && c.rank == 6;
    const Matrix6d own = Observable(c.Omega).covariance;
    const Se3& T_step = step.forward ? c.T_i_j : c.T_j_i;
    C = ComposeCovariance(C, T_step, step.forward ? own : InverseCovariance(c.T_i_j, own));
    T = T * T_step;
  }
  cycle.e = T.Normalized().Log();
  if (cycle.tested) cycle.statistic = cycle.e.dot(C.ldlt().solve(cycle.e));
  return cycle;
}

std::vector<std::size_t> KeyOf(const Walk& walk) {
  std::vector<std::size_t> key;
  for (const Step& step : walk) key.push_back(step.constraint);
  std::sort(key.begin(), key.end());
  return key;
}

Step StepFrom(const Problem& problem, std::size_t constraint, int vertex) {
  return {constraint, problem.constraints[constraint].i == vertex};
}

// Triangles whose first edge has the smallest number.
void AddTriangles(const Problem& problem, const std::vector<std::vector<std::size_t>>& at, std::size_t first,
                  std::vector<Walk>& walks) {
  const int i = problem.constraints[first].i, j = problem.constraints[first].j;
  for (const std::size_t second : at[static_cast<std::size_t>(j)]) {
    const int k = End(problem, StepFrom(problem, second, j));
    if (second <= first || k == i || k == j) continue;
    for (const std::size_t third : at[static_cast<std::size_t>(k)])
      if (third > first && third != second && End(problem, StepFrom(problem, third, k)) == i)
        walks.push_back({{first, true}, StepFrom(problem, second, j), StepFrom(problem, third, k)});
  }
}

}  // namespace

std::vector<CycleResidual> FindCycles(const Graph& graph, std::size_t cycles_max) {
  const Problem problem = MakeProblem(graph);
  if (problem.vertex_count == 0) return {};
  const auto at = ConstraintsAt(problem);
  const Tree tree = GrowBreadthFirst(problem, at);
  std::vector<Walk> walks;
  for (std::size_t k = 0; k < problem.constraints.size() && walks.size() < cycles_max; ++k)
    if (!tree.in_tree[k]) walks.push_back(LoopOf(problem, tree, k));
  for (std::size_t k = 0; k < problem.constraints.size() && walks.size() < cycles_max; ++k)
    AddTriangles(problem, at, k, walks);
  std::set<std::vector<std::size_t>> seen;
  std::vector<CycleResidual> cycles;
  for (const Walk& walk : walks)
    if (cycles.size() < cycles_max && seen.insert(KeyOf(walk)).second) cycles.push_back(Compose(graph, problem, walk));
  return cycles;
}

}  // namespace rigcal::graph
