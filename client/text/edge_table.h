// Edges for people: the table of good ones, then each failed one with its reason and cure.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "client/text/document.h"

namespace rigcal::client {

// "left - right"
[[nodiscard]] std::string PairOf(const Document& edge);

// Retired, of a superseded session, or measured before a sensor was remounted: no part of the solution any more.
[[nodiscard]] bool IsPast(const Document& edge);
enum class EdgeIds { kHidden, kShown };
// What to do about what is said of good edges: not told where a root cause has its own cure, as they may contradict.
enum class Cures { kTold, kLeftToTheCause };
// Rows as in docs/api.md, edges; with the first 12 digits of each id, if asked for.
void PrintEdges(const std::vector<Document>& edges, std::ostream& out, EdgeIds ids = EdgeIds::kHidden,
                Cures cures = Cures::kTold);
// One line: "left - right  stereo  good  sigma 0.08 0.06 0.21 mm, 0.010 0.012 0.004 deg"; of a failed one why, as what
// to do is told by the verdict, which knows what failed beside it.
[[nodiscard]] std::string EdgeLine(const Document& edge);
// "  why. What to do." per diagnosis.
void PrintDiagnoses(const Document& diagnoses, std::ostream& out, Cures cures = Cures::kTold);
// "E_global  before ... -> after ..." of a revision's document.
void PrintGlobalError(const Document& revision, std::ostream& out);

}  // namespace rigcal::client
