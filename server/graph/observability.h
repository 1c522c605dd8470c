// Which sensors' poses the edges determine, and which directions they leave free (edges may be rank-deficient).
#pragma once

#include <string>
#include <vector>

#include "server/graph/gauss_newton.h"

namespace rigcal::graph {

using FreeBasis = Eigen::Matrix<double, 6, Eigen::Dynamic>;

struct Observability {
  bool judged = true;                     // false: too many bodies: all but the reference's count as free
  int nullity = 0;                        // of H
  std::vector<FreeBasis> free_of_vertex;  // per vertex, right tangent at it; no columns: fully observable
  std::vector<Pin> pins;                  // one per free direction: with them H is regular
};

// A question of geometry, not of weights: sensors tied by edges of full rank move as one body; between the bodies every
// deficient edge counts with the directions it sees. Directions that two edges see only because noise turns them
// against each other count as free (three times the residual rotation is the measure).
[[nodiscard]] Observability Observe(const Problem& problem, const Poses& T_ref);

// H at these poses, the directions that edges leave open held, factored; null where it is not positive definite or would
// fill in.
[[nodiscard]] std::unique_ptr<BlockCholesky<6>> FactorAt(const Problem& problem, const Poses& T_ref);

// Free directions, each with a coordinate of its own that is 1 in it and 0 in the others; rotations first.
[[nodiscard]] FreeBasis Reduced(FreeBasis basis);
// "translation along z", "rotation about (0.71, 0.71, 0.00)", ...; in the sensor's own axes.
[[nodiscard]] std::string NameDirections(const FreeBasis& basis);

}  // namespace rigcal::graph
