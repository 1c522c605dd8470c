// Each camera's field of shifts as unknowns beside all others: the session's problem linearized once more, with every
// place and every shared unknown eliminated.
#pragma once

#include "server/calib/joint/refine.h"
#include "server/calib/joint/variance_components.h"

namespace rigcal::calib::joint {

struct FieldEquations {
  RandomEffects effects;          // per camera of the problem; no columns where its picture's size is not known
  Eigen::MatrixXd by_unknowns;    // -d unknowns / d coefficients at the optimum: H^-1 X, unknowns x coefficients
};
// Scores are those at fields of zero, whatever the state holds. Memory does not grow with the captures.
[[nodiscard]] FieldEquations FieldEquationsOf(const SessionProblem& problem, const Refined& refined);

}  // namespace rigcal::calib::joint
