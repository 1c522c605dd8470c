// Edges of one pair by one method as one: what is left of those that are not kept in full.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/stamp.h"
#include "server/model/edges/edge.h"

namespace rigcal {

// Sums over the edges i of `Omega_i` with what its error is told by: a quadratic cost in T_a_b has the sum of theirs as
// its own, and a score's scatter is the sum of theirs. All in the right tangent at b.
struct MergedEdge {
  SensorId frame_a, frame_b;
  std::string method;
  bool of_sessions = false;  // or pushed as finished results
  bool weak = false;         // of sessions: all of them say too little to be held against better ones (weak_edge.h)
  int part = 0;              // of pushed ones of a pair; above 0: they contradict those of the parts before
  int count = 0;
  Stamp newest;                                            // when the newest of them was measured
  Se3 T_a_b;                                               // their optimum
  Matrix6d Omega = Matrix6d::Zero();                       // sum Omega_i
  UncertaintySource source = UncertaintySource::kAssumed;  // of the newest
  int dof = 0;                                             // sum of theirs; 0: each is known
  bool by_blocks = false;                                  // at least one has block vectors
  Matrix6d scatter = Matrix6d::Zero();  // sum Omega_i C_i Omega_i, C_i of its blocks; Omega_i of one that has none
  Matrix6d visits = Matrix6d::Zero();   // likewise, of what pushed ones scatter by from visit to visit besides
  Matrix6d given = Matrix6d::Zero();    // likewise, of given constants of its own
  std::map<std::string, std::vector<Vector6d>> constants;  // by name, per constant: sum Omega_i times its shift
  // Of sessions: a column per independent cause, the same ones in all merged edges of a robot's sessions, as pairs of a
  // session share captures; scores scores^T is `scatter`, and scores_x scores_y^T what two pairs have in common. Kept
  // of a robot's newest revision only: no columns elsewhere.
  Eigen::Matrix<double, 6, Eigen::Dynamic> scores;
};

// Figure of an edge that stands for as many that were pushed as finished results, or one of each of so many sessions.
inline constexpr const char *kMergedEdges = "merged_edges", *kMergedSessions = "merged_sessions";
// Figure of a merged edge beside it: MergedEdge::part, where that is not 0.
inline constexpr const char* kMergedPart = "merged_part_idx";
// What merged edges of sessions have in the place of a session: no session has this id.
inline const SessionId kMergedHistory("merged");
[[nodiscard]] inline bool IsMergedOfSessions(const Edge& edge) { return edge.figures.contains(kMergedSessions); }
[[nodiscard]] inline bool IsMerged(const Edge& edge) {
  return edge.figures.contains(kMergedEdges) || IsMergedOfSessions(edge);
}

}  // namespace rigcal
