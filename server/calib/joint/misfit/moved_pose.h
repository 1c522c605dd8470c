// Is one rig before boards that stand still behind all captures? A scan over sensors, the reference included, boards
// and captures for a change of one pose during the session (score test for a change point; Andrews 1993).
#pragma once

#include "server/calib/joint/refine/refine.h"
#include "server/model/sessions/session_estimate.h"

namespace rigcal::calib::joint {

constexpr int kGroupsForMoves = 6;  // fewer do not tell a bump from chance

struct Move {
  int sensor = kNone, board = kNone;        // of which one moved
  int or_sensor = kNone, or_board = kNone;  // this one instead explains as much: nothing tells which of them moved
  int group = 0;                            // of captures; the first after the move
  Vector6d step = Vector6d::Zero();         // T_after = T_before Exp(step), right tangent at the sensor or the board
  double gain = 0.0;                        // of the cost
  double statistic = 0.0;                   // F
  double odds = 1.0;                        // of so large a statistic anywhere in the scan by chance, at most
  double scatter = 1.0;                     // mean square of the groups' scores beside the change
  Matrix6d information = Matrix6d::Zero();  // on the step, scatter included; none along what is left open
  std::optional<FocalChange> lens = {};  // of a camera: the same as a change of its lens, where that explains as much
};

// The likeliest change of each sensor and board that was seen in two groups or three captures on either side of it, the
// least odds first; of two that explain as much (of two sensors, of a board and the only sensor that saw it) the first
// names the other.
// The scatter of a sensor's captures beyond the change is its own measure of noise: a lens that does not fit moves a
// sensor with the place in the picture, a bump with time.
[[nodiscard]] std::vector<Move> ScanForMoves(const SessionProblem& problem, const Refined& refined);

// Of sensors, the reference included, what they saw last as a change that is none of chance (kMovedOdds) and surely
// large enough to be told (IsMove), where that is too little for ScanForMoves: one capture, or two of one place.
[[nodiscard]] std::vector<Move> ScanForLateMoves(const SessionProblem& problem, const Refined& refined);

// Covariance of the unknowns by changes that are none of chance (kMovedOdds) and are still in `refined`, as too small
// to be told (IsMove) or not to be taken out: each by what the newest poses would be moved by if it were allowed for.
// Empty: there are none.
[[nodiscard]] Eigen::MatrixXd CovarianceByMovesLeft(const SessionProblem& problem, const Refined& refined);

// Of each of `sensors` the smallest move that the scan would have told (odds below kMovedOdds after correction for its
// looks, and IsMove) with a probability of 95 %: noncentral F with the sensor's own scatter, along the direction in
// which translation (rotation) is known worst, half-way through the groups that it is seen in. `kAnyMove` where a
// direction is not seen or where there are fewer groups than the scan needs.
[[nodiscard]] std::vector<SmallestMove> SmallestMovesTold(const SessionProblem& problem, const Refined& refined,
                                                          const std::vector<int>& sensors);

}  // namespace rigcal::calib::joint
