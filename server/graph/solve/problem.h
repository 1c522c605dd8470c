// A graph made canonical for the numerical core: the reference's connected part, edges sorted by id, vertices numbered
// in elimination order. Two graphs with the same edges in any order give the same Problem, bit by bit.
#pragma once

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "server/graph/large/block_matrix.h"
#include "server/model/graph/graph.h"

namespace rigcal::graph {

// One edge that takes part. Vertices i = frame_a, j = frame_b. Omega is that of the edge, right tangent at j: along
// directions that it does not see it is zero, and the constraint has nothing to say there.
struct Constraint {
  int i = 0, j = 0;
  Se3 T_i_j;  // as measured
  Se3 T_j_i;  // its inverse
  Matrix6d Omega = Matrix6d::Zero();
  int rank = 6;
  double log_det_Omega = 0.0;  // meaningful if rank is 6
  int slot = -1;               // of the off-diagonal block H(later, earlier); -1: the reference is one end
  std::size_t edge = 0;        // index into edges_by_id
};

struct Problem {
  int vertex_count = 0;               // with the reference, which is vertex 0 and fixed
  std::vector<int> vertex_of_sensor;  // per Graph::sensors; -1: not connected to the reference
  std::vector<std::size_t> sensor_of_vertex;
  std::vector<std::size_t> edges_by_id;  // indices into Graph::edges
  std::vector<Constraint> constraints;   // in the order of edges_by_id
  BlockPattern pattern;                  // of the free vertices 1..n as blocks 0..n-1
  EliminationCost elimination_cost;      // of that pattern
  std::vector<Diagnosis> diagnoses;      // sensors that are not connected, edges that cannot be used

  // Vertices whose poses are sought: all but the reference.
  [[nodiscard]] int free_count() const { return vertex_count > 0 ? vertex_count - 1 : 0; }
  // Whether every edge sees all six directions.
  [[nodiscard]] bool HasFullRank() const {
    return std::all_of(constraints.begin(), constraints.end(), [](const Constraint& c) { return c.rank == 6; });
  }
};

// Everything of a constraint but its vertices and slot, if the edge can be used; otherwise why it cannot.
[[nodiscard]] std::string FillConstraint(const GraphEdge& edge, std::size_t edge_idx, Constraint& constraint);
// Edges that cannot be used are left out, and told in `diagnoses`; so are sensors that no path leads to.
[[nodiscard]] Problem MakeProblem(const Graph& graph);

// Disjoint sets of vertices.
class UnionFind {
 public:
  // Members 0 to count - 1, each in a set of its own.
  explicit UnionFind(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  // The smallest member of the set of `member`.
  [[nodiscard]] int Find(int member) {
    while (At(member) != member) member = At(member) = At(At(member));
    return member;
  }
  // False if both were in one set already.
  bool Join(int a, int b) {
    a = Find(a), b = Find(b);
    if (a > b) std::swap(a, b);
    At(b) = a;
    return a != b;
  }

 private:
  int& At(int member) { return parent_[static_cast<std::size_t>(member)]; }
  std::vector<int> parent_;
};

}  // namespace rigcal::graph
