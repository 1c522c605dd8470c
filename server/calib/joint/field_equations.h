// Each camera's field of shifts as unknowns beside all others: the session's problem linearized once more, with every
// place and every shared unknown eliminated.
#pragma once

#include "server/calib/joint/refine.h"
#include "server/calib/joint/variance_components.h"

namespace rigcal::calib::joint {

struct FieldEquations {
  // Per camera of the problem the control points that its corners reach: their coefficients of u, then of v. None where
  // the size of its picture is not known.
  std::vector<std::vector<int>> seen_points;
  RandomEffects effects;
  Eigen::MatrixXd by_unknowns;  // -d unknowns / d coefficients at the optimum: H^-1 X, unknowns x coefficients
};
// Scores are those at fields of zero, whatever the state holds. Memory does not grow with the captures.
[[nodiscard]] FieldEquations FieldEquationsOf(const SessionProblem& problem, const Refined& refined);

}  // namespace rigcal::calib::joint
