// The chordal start: all rotations at once by linear least squares on 3x3 matrices, projected onto SO(3), then all
// translations (Martinec & Pajdla 2007; Carlone et al. 2015). It does not drift along chains as a tree does.
#pragma once

#include <optional>

#include "server/graph/linearize.h"

namespace rigcal::graph {

// Empty if a linear system cannot be factored.
[[nodiscard]] std::optional<Poses> ChordalPoses(const Problem& problem);

}  // namespace rigcal::graph
