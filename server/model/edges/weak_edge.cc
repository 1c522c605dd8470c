#include "server/model/edges/weak_edge.h"

#include <cmath>

#include "server/model/edges/merged_edge.h"
#include "server/model/edges/method.h"

namespace rigcal {

std::string WhyWeak(const Edge& edge) {
  if (edge.state != EdgeState::kGood || edge.method != NameOf(Method::kLidarLidar)) return {};
  if (edge.session.empty() && !IsMergedOfSessions(edge)) return {};
  if (edge.figures.contains(kMergedWeak)) return "in earlier sessions the two saw too little alike";
  if (edge.uncertainty.rank < 6) return "it sees " + std::to_string(edge.uncertainty.rank) + " of 6 directions";
  const auto overlap = edge.figures.find("overlap_ratio");
  if (overlap == edge.figures.end() || overlap->second >= kWeakOverlap_ratio) return {};
  return std::to_string(std::lround(100.0 * overlap->second)) + " % of one cloud lie where the other has points";
}

}  // namespace rigcal
