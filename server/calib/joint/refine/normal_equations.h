// The session's problem linearized: per place, then with the places eliminated (Schur complement), per group of
// captures.
#pragma once

#include "server/calib/joint/problem/capture_groups.h"
#include "server/calib/joint/problem/observation.h"

namespace rigcal::calib::joint {

// Of whole looks, in the order of the problem's lists; 1: counts in full.
struct LookWeights {
  std::vector<double> corners, plates, poses;  // below 1: contradicts the others
  std::vector<double> in_burst;                // of corners: below 1: has errors in common with others
  // Of the i-th look of problem.corners.
  [[nodiscard]] double OfCorners(std::size_t i) const { return corners[i] * in_burst[i]; }
};
// Every look counts in full.
[[nodiscard]] LookWeights FullWeights(const SessionProblem& problem);

struct NormalEquations {
  Eigen::MatrixXd H;  // over Layout::columns
  Eigen::VectorXd b;
};

struct PlaceEquations {
  Matrix6d inverse = Matrix6d::Zero();  // of its own normal matrix; zero along what nothing tells
  Vector6d b = Vector6d::Zero();
  Eigen::MatrixXd by_shared;  // 6 x unknowns
};

// What one look said at the state: squares of its residuals in sigmas, how many numbers, and how many of them the
// unknowns take up (leverage; filled by AddLeverage). Of a tracker translation and rotation apart, of others first; of
// a camera whose looks err as a whole that error second, and what is left of its log determinant. Neither is less where
// a look counts less.
struct LookFit {
  Eigen::Vector2d squares = Eigen::Vector2d::Zero(), numbers = Eigen::Vector2d::Zero();
  Eigen::Vector2d leverage = Eigen::Vector2d::Zero();
  double log_det = 0.0;
};
struct SessionFit {
  std::vector<LookFit> corners, plates, poses;
};

struct Linearized {
  std::vector<NormalEquations> groups;  // places eliminated; without what is given
  NormalEquations given;                // priors and relative poses known from elsewhere
  NormalEquations total;                // what is given and all groups together
  std::vector<PlaceEquations> places;
  SessionFit fit;
  double cost = 0.0;
};

struct Linearization {
  const SessionProblem& problem;
  const Layout& layout;
  const std::vector<SensorNoise>& noise;  // per sensor
  const LookWeights& weights;
  const CaptureGroups& groups;
};
// Nothing where a camera cannot see a corner that it saw. Deterministic for any number of threads.
[[nodiscard]] std::optional<Linearized> Linearize(const Linearization& of, const SessionState& state);
// How much of each look the unknowns take up: tr(J C J^T) per look, C the covariance of all unknowns.
void AddLeverage(const Linearization& of, const SessionState& state, const Eigen::MatrixXd& covariance,
                 Linearized& linearized);

}  // namespace rigcal::calib::joint
