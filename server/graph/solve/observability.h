// Which sensors' poses the edges determine, and which directions they leave free (edges may be rank-deficient).
#pragma once

#include <string>
#include <vector>

#include "server/graph/solve/gauss_newton.h"

namespace rigcal::graph {

using FreeBasis = Eigen::Matrix<double, 6, Eigen::Dynamic>;

struct Observability {
  bool judged = true;                     // false: too many bodies: all but the reference's count as free
  int nullity = 0;                        // of H
  std::vector<FreeBasis> free_of_vertex;  // per vertex, right tangent at it; no columns: fully observable
  std::vector<Pin> pins;                  // one per free direction: with them H is regular
  // Per vertex, what each free motion of the whole moves it by, likewise; nothing where there is none, or none was
  // judged.
  std::vector<FreeBasis> motion_of_vertex;
  Vector6d scale = Vector6d::Ones();  // by which metres and radians were compared
  double visible = 0.0;               // what of a motion, scaled, is more than noise
};

// A question of geometry, not of weights: sensors tied by edges of full rank move as one body; between the bodies every
// deficient edge counts with the directions it sees. Directions that two edges see only because noise turns them
// against each other count as free (three times the residual rotation is the measure).
[[nodiscard]] Observability Observe(const Problem& problem, const Poses& T_ref);

// What is free of T_i_j, right tangent at vertex j: nothing where both move alike, free as each of them may be.
[[nodiscard]] FreeBasis FreeBetween(const Observability& observability, int i, int j, const Se3& T_i_j);

// H at these poses, the directions that edges leave open held, factored; null where it is not positive definite or
// would fill in.
[[nodiscard]] std::unique_ptr<BlockCholesky<6>> FactorAt(const Problem& problem, const Poses& T_ref);

// Free directions, each with a coordinate of its own that is 1 in it and 0 in the others; rotations first.
[[nodiscard]] FreeBasis Reduced(FreeBasis basis);
// Its columns.
[[nodiscard]] std::vector<Vector6d> ColumnsOf(const FreeBasis& basis);
// Those as columns.
[[nodiscard]] FreeBasis BasisOf(const std::vector<Vector6d>& directions);
// "translation along z", "rotation about (0.71, 0.71, 0.00)", ...; in the sensor's own axes.
[[nodiscard]] std::string NameDirections(const FreeBasis& basis);

}  // namespace rigcal::graph
