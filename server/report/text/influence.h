// Which capture moves an edge's answer: the edge's block vectors, read. What the edge does to the solution.
#pragma once

#include <vector>

#include "server/model/edges/uncertainty.h"
#include "server/model/graph/insight.h"

namespace rigcal::report {

struct Influence {
  std::string
      block_id;  // the capture, or group of captures, whose absence moves the position most; empty: no block vectors
  double position_m = 0.0, rotation_rad = 0.0;
  double in_sigmas = 0.0;  // largest |d| / sigma of the six axes
};
// Of blocks that move the position alike the first.
[[nodiscard]] Influence LargestInfluence(const std::vector<BlockVector>& blocks, const Uncertainty& uncertainty);
// "Leaving out 07 moves the position most: by 0.12 mm and 0.004 deg, 0.4 sigma."; empty without block vectors.
[[nodiscard]] std::string InfluenceText(const Influence& influence);
// nullptr: not worked out for this edge.
[[nodiscard]] const EdgeInfluence* InfluenceOf(const Influences& influences, const EdgeId& edge);

}  // namespace rigcal::report
