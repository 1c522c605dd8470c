#include "server/report/text/influence.h"

#include <algorithm>
#include <cmath>

#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

double InSigmas(const Vector6d& d, const Uncertainty& uncertainty) {
  double largest = 0.0;
  for (int axis = 0; axis < 6; ++axis) {
    const AxisSigma sigma = SigmaOf(uncertainty, axis);
    if (sigma.known && sigma.value > 0.0) largest = std::max(largest, std::abs(d(axis)) / sigma.value);
  }
  return largest;
}

}  // namespace

Influence LargestInfluence(const std::vector<BlockVector>& blocks, const Uncertainty& uncertainty) {
  Influence largest;
  for (const BlockVector& block : blocks) {
    const double moved_m = block.d.head<3>().norm();
    if (!largest.block_id.empty() && !(moved_m > largest.position_m)) continue;
    largest = {block.block_id, moved_m, block.d.tail<3>().norm(), InSigmas(block.d, uncertainty)};
  }
  return largest;
}

const EdgeInfluence* InfluenceOf(const Influences& influences, const EdgeId& edge) {
  const auto found = std::lower_bound(influences.edges.begin(), influences.edges.end(), edge,
                                      [](const EdgeInfluence& one, const EdgeId& id) { return one.edge < id; });
  return found != influences.edges.end() && found->edge == edge ? &*found : nullptr;
}

std::string InfluenceText(const Influence& influence) {
  if (influence.block_id.empty()) return "";
  return "Leaving out " + influence.block_id + " moves the position most: by " +
         Significant(influence.position_m * kMmPerMetre, 3) + " mm and " +
         Significant(influence.rotation_rad * kDegPerRad, 3) + " deg, " + Fixed(influence.in_sigmas, 1) + " \xCF\x83.";
}

}  // namespace rigcal::report
