// The causes of a revision's failed pairs, for people: each once, with its command on a line of its own, to be copied.
#pragma once

#include <ostream>
#include <vector>

#include "client/text/document.h"

namespace rigcal::client {

// `causes`: those of a revision's document (docs/api.md, causes). Nothing where there are none.
void PrintCauses(const Document& causes, std::ostream& out);
// The edges of the revision, the failed ones that a cause explains by their pairs alone, a list per cause; a failure of
// a pair that failed again since stands with that.
void PrintEdgesByCause(const Document& causes, const std::vector<Document>& edges, std::ostream& out);

}  // namespace rigcal::client
