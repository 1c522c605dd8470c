#include "server/graph/live/leaf_vertices.h"

#include <algorithm>

namespace rigcal::graph {

LeafVertices::LeafVertices(const std::vector<Constraint>& constraints, int vertex_count)
    : edge_of_(static_cast<std::size_t>(vertex_count), -1) {
  std::vector<int> count(edge_of_.size(), 0), sum(edge_of_.size(), 0);  // edges; of their numbers
  const auto add = [&](int edge, int sign) {
    const Constraint& constraint = constraints[static_cast<std::size_t>(edge)];
    for (const int vertex : {constraint.i, constraint.j})
      count[static_cast<std::size_t>(vertex)] += sign, sum[static_cast<std::size_t>(vertex)] += sign * edge;
  };
  for (std::size_t k = 0; k < constraints.size(); ++k) add(static_cast<int>(k), 1);
  for (std::size_t v = edge_of_.size(); v-- > 1;) {
    if (count[v] != 1) continue;
    const Constraint& only = constraints[static_cast<std::size_t>(sum[v])];
    if (std::min(only.i, only.j) == static_cast<int>(v)) continue;
    edge_of_[v] = sum[v];
    add(sum[v], -1);
  }
}

std::vector<int> LeafVertices::Activate(int vertex, const std::vector<Constraint>& constraints) {
  std::vector<int> edges;
  for (int edge = 0; (edge = edge_of_[static_cast<std::size_t>(vertex)]) >= 0;) {
    edge_of_[static_cast<std::size_t>(vertex)] = -1;
    edges.push_back(edge);
    const Constraint& constraint = constraints[static_cast<std::size_t>(edge)];
    vertex = constraint.i == vertex ? constraint.j : constraint.i;
  }
  return edges;
}

void LeafVertices::Renumber(const Constraint& constraint, std::size_t from, std::size_t to) {
  for (const int vertex : {constraint.i, constraint.j})
    if (int& at = edge_of_[static_cast<std::size_t>(vertex)]; at == static_cast<int>(from)) at = static_cast<int>(to);
}

bool LeafVertices::IsHeldBy(std::size_t edge, const Constraint& constraint) const {
  return edge_of_[static_cast<std::size_t>(std::max(constraint.i, constraint.j))] == static_cast<int>(edge);
}

Se3 LeafVertices::PoseOf(int leaf, const std::vector<Constraint>& constraints, const Poses& T_ref) const {
  const Constraint& constraint = constraints[static_cast<std::size_t>(edge_of_[static_cast<std::size_t>(leaf)])];
  if (constraint.j == leaf) return (T_ref[static_cast<std::size_t>(constraint.i)] * constraint.T_i_j).Normalized();
  return (T_ref[static_cast<std::size_t>(constraint.j)] * constraint.T_j_i).Normalized();
}

}  // namespace rigcal::graph
