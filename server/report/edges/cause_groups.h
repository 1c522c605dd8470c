// Failed edges by the cause that explains them: what they have in common is told once.
#pragma once

#include "server/report/edges/edge_order.h"
#include "server/report/frame/page.h"

namespace rigcal::report {

struct EdgeGroup {
  const Cause* cause = nullptr;
  std::vector<const ShownEdge*> edges;  // two or more, in the order of the page
  std::size_t pairs = 0;                // of sensors: one may have failed several times
  std::string anchor;                   // of its fold; empty: none of the edges has a section
};
struct EdgesByCause {
  std::vector<EdgeGroup> groups;         // in the order of the causes
  std::vector<const ShownEdge*> others;  // good, past, explained by no cause, or alone by one; in the order of the page
};
// An older failure of a pair stands with its newest; an edge that two causes explain with the first of them. Points
// into both arguments.
[[nodiscard]] EdgesByCause GroupByCause(const formats::RevisionInput& revision, const std::vector<ShownEdge>& edges);

// "left -> right", each linked to its section: PAIRS with pairs.tpl in it. What is too long is named.
void FillPairs(Dictionary& parent, const std::vector<const ShownEdge*>& edges);

}  // namespace rigcal::report
