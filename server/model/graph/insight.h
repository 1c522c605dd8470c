// What a solution rests on: what leaving out one edge would change, and how well loops of edges close.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/base/ids.h"
#include "server/math/se3.h"

namespace rigcal {

struct EdgeInfluence {
  EdgeId edge;
  bool checked = false;              // false: no other path between its sensors; then no numbers
  double t_squared = 0.0;            // of the edge against what the others say, all taken as independent
  SensorId most_moved;               // by leaving the edge out, in its sigmas; empty: no sensor
  Vector6d move = Vector6d::Zero();  // Log(T_with^-1 T_without) of that sensor, right tangent
  double move_sigmas = 0.0;          // sqrt(move^T C^-1 move), C the sensor's covariance with the edge
  // What the others say, less what the edge says: Log(T_a_b_measured^-1 T_a_b_others), right tangent at b, without the
  // directions in which nothing checks it. Not part of documents, which have the verdict.
  Vector6d off = Vector6d::Zero();
};

struct Influences {
  bool judged = false;
  std::string why_not;               // a sentence, where they were left out; empty: they were not asked for
  std::vector<EdgeInfluence> edges;  // of the solution, sorted by id
};

struct CycleResidual {
  std::vector<EdgeId> edges;      // in the order of the walk
  std::vector<SensorId> sensors;  // likewise; the walk starts and ends at the first
  // Log of the composed measurements, right tangent at the first sensor. Of a tested loop without its part along the
  // directions that any of its edges leaves open.
  Vector6d e = Vector6d::Zero();
  bool tested = false;     // along the other directions, if there are any
  double t_squared = 0.0;  // e^T C_e^-1 e, by the covariance of this very residual
  int rank = 0;            // of C_e: directions in which the loop checks anything
  double dof = 0.0;        // behind the estimate of C_e; 0: known
  double limit = 0.0;      // of t_squared, for all tested cycles together; 0: too few captures for one

  // False where it was not tested.
  [[nodiscard]] bool fails() const { return limit > 0.0 && t_squared > limit; }
};

struct Cycles {
  bool judged = false;
  std::string why_not;  // a sentence, where all or some were left out
  std::int64_t examined = 0, failing = 0;
  std::int64_t tested = 0;  // those that have a limit
  // Furthest beyond its limit first; those without a test last. Of those that fail the most open one is among them.
  std::vector<CycleResidual> worst;
  // The tested ones beside these, which may be open by much within their sigmas. Not part of documents, which have the
  // verdict.
  std::vector<CycleResidual> others = {};

  // Of all of these; they stay valid as long as both lists are not changed.
  [[nodiscard]] std::vector<const CycleResidual*> Loops() const {
    std::vector<const CycleResidual*> loops;
    for (const auto* list : {&worst, &others})
      for (const CycleResidual& loop : *list) loops.push_back(&loop);
    return loops;
  }
};

}  // namespace rigcal
