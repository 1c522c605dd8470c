// How an edge fits, as the drawing and the table show it: a class for its colour, a width for its information.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "server/report/edges/edge_order.h"

namespace rigcal::report {

// Edges that nothing checks, and in words what the others do not check of some: a residual says nothing of that part.
struct UncheckedParts {
  std::set<EdgeId> whole;
  std::map<EdgeId, std::string> in_part;                   // "the height is not checked by anything else"
  [[nodiscard]] std::string Of(const EdgeId& edge) const;  // empty: all of it is checked
};
[[nodiscard]] UncheckedParts UncheckedPartsOf(const formats::RevisionInput& revision);

// SigmasClass() of its residual; "unchecked" if the other edges check nothing of it, or not all and what they check
// fits; "failed".
[[nodiscard]] const char* FitClass(const ShownEdge& shown, const UncheckedParts& unchecked);

// Edges that the others speak against, each alone; and those of which one is wrong and nobody can tell which.
struct Contradictions {
  std::set<EdgeId> suspects, alternatives;
};
// An edge that is suspected alone is no alternative as well.
[[nodiscard]] Contradictions ContradictionsOf(const Suspects& suspects);

// Stroke widths between the least and the most certain edge, by the logarithm of the largest sigma of the position.
class InformationScale {
 public:
  // The scale of these edges; those without information take no part.
  explicit InformationScale(const std::vector<ShownEdge>& edges);
  // The thinnest for an edge without information; all alike where the edges are about equally certain.
  [[nodiscard]] double Width_px(const Edge& edge) const;

 private:
  double least_ = 0.0, most_ = 0.0;
};

}  // namespace rigcal::report
