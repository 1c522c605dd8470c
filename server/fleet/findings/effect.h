// Whether what chance does not explain also matters, and whether what chance explains is too much.
//
// How far an edge is off is what it says against all others (EdgeInfluence::off). Of a graph too large for that it is
// not known: then chance alone decides, as no sum of small residuals is small by itself.
#pragma once

#include "server/fleet/findings/findings.h"

namespace rigcal::fleet {

// Chance does not explain it, but it is no more than the policy's least move of these two. False where it is not known.
[[nodiscard]] bool IsSmall(const Edge& edge, const GraphSolution& solution, const Policy& policy);
// No edge and no loop that was worked out is off by more than that.
[[nodiscard]] bool AllIsSmall(const std::vector<Edge>& edges, const GraphSolution& solution, const Policy& policy);
// `solution` without what is so small of what accuses: suspects, sensors with two poses, loops that do not close.
[[nodiscard]] GraphSolution WithoutSmall(const GraphSolution& solution, const Policy& policy);

// The largest of what chance does not explain and is that small; without a stop, empty where there is none.
[[nodiscard]] std::string SmallDisagreements(const std::vector<Edge>& edges, const GraphSolution& solution,
                                             const Policy& policy);
// An edge by its worst axes, which are beyond its tolerance: what it disagrees in may be no more than chance.
struct WeakEdge {
  const Edge* edge = nullptr;
  double sigma_m = 0.0, sigma_rad = 0.0;
  PoseLimit limit;
  [[nodiscard]] double Times() const;  // the limit, whichever half is larger
};
// By far the weakest of these, beyond its tolerance; nothing where none is.
[[nodiscard]] std::optional<WeakEdge> WeakestOf(const std::vector<const Edge*>& edges, const Policy& policy);
// That these are not checked for it: it is to be measured again.
[[nodiscard]] Finding NotCheckedFor(const std::vector<const Edge*>& unchecked, const WeakEdge& weakest);
// Edges and loops that are off by more than the policy's tolerance, though it may be chance. What disagrees for a weak
// edge alone is told as that, by itself: it hides nothing that others disagree in without it.
[[nodiscard]] std::vector<Finding> FindLargeDisagreements(const std::vector<Edge>& edges, const GraphSolution& solution,
                                                          const Policy& policy);

}  // namespace rigcal::fleet
