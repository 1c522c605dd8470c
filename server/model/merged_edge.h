// Edges of one pair by one method as one: what is left of those that are not kept in full.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/stamp.h"
#include "server/model/edge.h"

namespace rigcal {

// Sums over the edges i of `Omega_i` with what its error is told by: a quadratic cost in T_a_b has the sum of theirs as its
// own, and a score's scatter is the sum of theirs. All in the right tangent at b.
struct MergedEdge {
  SensorId frame_a, frame_b;
  std::string method;
  int count = 0;
  Stamp newest;                          // when the newest of them was measured
  Se3 T_a_b;                             // their optimum
  Matrix6d Omega = Matrix6d::Zero();     // sum Omega_i
  UncertaintySource source = UncertaintySource::kAssumed;  // of the newest
  int dof = 0;                           // sum of theirs; 0: each is known
  bool by_blocks = false;                // at least one has block vectors
  Matrix6d scatter = Matrix6d::Zero();   // sum Omega_i C_i Omega_i, C_i of its blocks; Omega_i of one that has none
  Matrix6d given = Matrix6d::Zero();     // likewise, of given constants of its own
  std::map<std::string, std::vector<Vector6d>> constants;  // by name, per constant: sum Omega_i times its shift
};

// Figure of an edge that stands for as many.
inline constexpr const char* kMergedEdges = "merged_edges";
[[nodiscard]] inline bool IsMerged(const Edge& edge) { return edge.figures.contains(kMergedEdges); }

}  // namespace rigcal
