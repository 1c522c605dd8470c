// Does a camera bend its pictures in a way that its model cannot describe? A smooth field of shifts per camera as
// random effects whose size the session tells (empirical Bayes): found, taken out as far as it is known, the rest in
// the sigmas.
#pragma once

#include "server/calib/joint/refine/cluster_covariance.h"
#include "server/calib/joint/refine/refine.h"
#include "server/calib/joint/refine/variance_components.h"
#include "server/model/sessions/session_estimate.h"

namespace rigcal::calib::joint {

// Each camera's field of shifts as unknowns beside all others: the session's problem linearized once more, with every
// place and every shared unknown eliminated.
struct FieldEquations {
  // Per camera of the problem the control points that its corners reach: their coefficients of u, then of v. None where
  // the size of its picture is not known.
  std::vector<std::vector<int>> seen_points;
  RandomEffects effects;
  Eigen::MatrixXd by_unknowns;  // -d unknowns / d coefficients at the optimum: H^-1 X, unknowns x coefficients
};
// Scores are those at fields of zero, whatever the state holds. Memory does not grow with the captures.
[[nodiscard]] FieldEquations FieldEquationsOf(const SessionProblem& problem, const Refined& refined);

// Of a camera without misfit the evidence is beyond it once in 250,000 times.
constexpr double kMisfitEvidence = 20.0;

struct FoundMisfits {
  FieldEquations equations;
  Components components;  // per camera of the problem
  bool held = false;      // the state that it was found at has the fields taken out
  // Whether a camera's evidence reaches kMisfitEvidence.
  [[nodiscard]] bool any() const;
};
// Looked for in what `refined` leaves unexplained; cameras whose picture's size is not known have none.
[[nodiscard]] FoundMisfits FindMisfits(const SessionProblem& problem, const Refined& refined);

// The state with each field at its mean, given what was seen.
[[nodiscard]] SessionState WithFields(const SessionProblem& problem, const FoundMisfits& found, SessionState state);
// True where the fields that both found are the same within what matters to a pose.
[[nodiscard]] bool SameFields(const FoundMisfits& x, const FoundMisfits& y);

// What is not known of the fields, as covariance of the layout's unknowns.
[[nodiscard]] Eigen::MatrixXd CovarianceByFields(const FoundMisfits& found);

// Of the cameras that have one: rms, and what each does to the poses. `covariance` has the fields' beside it.
[[nodiscard]] std::vector<LensMisfit> MisfitsTold(const SessionProblem& problem, const Refined& refined,
                                                  const FoundMisfits& found, const PoseCovariance& covariance);

}  // namespace rigcal::calib::joint
