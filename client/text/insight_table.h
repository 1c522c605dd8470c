// What a revision rests on, for people: the edges that move it most, and how its loops close.
#pragma once

#include <ostream>

#include "client/text/document.h"

namespace rigcal::client {

// Of a revision's document (docs/api.md, show): the edges without which a pose changes most, in its sigmas. Nothing for
// documents from before influence.
void PrintInfluence(const Document& revision, std::ostream& out);
// The loops that close worst, with their test; those that fail are marked.
void PrintLoops(const Document& revision, std::ostream& out);

}  // namespace rigcal::client
