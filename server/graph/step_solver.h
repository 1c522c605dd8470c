// Who solves for the steps of a descent: a Cholesky factor, or conjugate gradients where the factor would fill in.
#pragma once

#include <memory>

#include "server/graph/problem.h"

namespace rigcal::graph {

// True where every vertex is a few edges from the reference (then conjugate gradients need few iterations) and a factor
// would cost far more than they do. A matter of structure alone: numbers do not enter.
[[nodiscard]] bool PrefersConjugateGradients(const Problem& problem);

// Null if a factor is needed and would be too large. What it gives for Factor() reads that matrix until the next
// Factor(): it must stay as it is in between.
[[nodiscard]] std::unique_ptr<BlockCholesky<6>> MakeStepSolver(const Problem& problem);

}  // namespace rigcal::graph
