// Vertices that one edge holds: they follow their neighbour and take no part in a descent, until a second edge comes.
// A leaf may hold further leaves, which came after it; so poses can follow in the order of vertices.
#pragma once

#include <vector>

#include "server/graph/solve/linearize.h"

namespace rigcal::graph {

// Sensors that hang on one edge: their pose is the neighbour's times the measurement, at no cost, so they take no part
// in solving.
class LeafVertices {
 public:
  LeafVertices() = default;
  // All that there are: vertices with one edge, or one beside those of their leaves, if it leads to a vertex that came
  // before. (An edge that left may leave a later one behind; such a vertex takes part.)
  LeafVertices(const std::vector<Constraint>& constraints, int vertex_count);

  // The newest vertex is held by this edge alone.
  void Add(std::size_t edge) { edge_of_.push_back(static_cast<int>(edge)); }
  // The vertex, and all that hold it, take part from now on: their edges, from the vertex on.
  [[nodiscard]] std::vector<int> Activate(int vertex, const std::vector<Constraint>& constraints);
  // An edge between these two vertices has another number now.
  void Renumber(const Constraint& constraint, std::size_t from, std::size_t to);

  // It follows its neighbour, and is no unknown.
  [[nodiscard]] bool IsLeaf(int vertex) const { return edge_of_[static_cast<std::size_t>(vertex)] >= 0; }
  // Whether this edge holds a leaf.
  [[nodiscard]] bool IsHeldBy(std::size_t edge, const Constraint& constraint) const;
  // T_ref_leaf from its neighbour's pose in T_ref and the measurement.
  [[nodiscard]] Se3 PoseOf(int leaf, const std::vector<Constraint>& constraints, const Poses& T_ref) const;

 private:
  std::vector<int> edge_of_;  // of a vertex: the one edge that holds it; -1: it takes part
};

}  // namespace rigcal::graph
