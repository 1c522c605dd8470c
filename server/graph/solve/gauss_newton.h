// Minimises the weighted cost: Gauss-Newton, with Levenberg-Marquardt damping only where a full step does not help.
#pragma once

#include <array>
#include <vector>

#include "server/graph/solve/linearize.h"

namespace rigcal::graph {

// A coordinate of the step that is held, because no edge says anything about it.
struct Pin {
  int row = 0;  // of H
  friend bool operator==(const Pin&, const Pin&) = default;
};

// Where a descent ended. `cost` = sum e^T Omega e, in squared sigmas; not `converged`: the lowest that was found.
struct Optimum {
  Poses T_ref;
  std::vector<Vector6d> residuals;  // by constraint; empty if they are not at hand
  double cost = 0.0;
  int iterations = 0;
  bool converged = false;
};

// Converged: the next step would lower the cost by less than 1e-14 of it, or moves nothing by more than 1e-12.
[[nodiscard]] Optimum Optimize(const Problem& problem, const Poses& start, const std::vector<Pin>& pins,
                               BlockCholesky<6>& cholesky, int iterations_max);

// Stiffens the pinned coordinates; exact for everything that does not depend on them.
void AddPins(const std::vector<Pin>& pins, BlockMatrix<6>& H);

// What the steps taken since the last factorisation tell about the Hessian that the factor does not know: limited-
// memory BFGS (Nocedal 1980, the two-loop recursion) with the factor as its starting matrix.
class SecantPairs {
 public:
  // For a new factor, beside which nothing is known yet.
  void Clear() { count_ = 0; }

  // The gradient changed by `change` over `step`. Forgotten if there is no room, or no curvature along the step.
  void Remember(const Eigen::VectorXd& step, const Eigen::VectorXd& change) {
    if (count_ == pairs_.size() || !(step.dot(change) > 0.0)) return;
    Pair& pair = pairs_[count_++];
    pair.step = step;
    pair.change = change;
    pair.rho = 1.0 / step.dot(change);
  }

  // x <- M x, with `solve(x)` for x <- factor^-1 x in place.
  template <typename Solve>
  void Apply(Eigen::VectorXd& x, const Solve& solve) {
    for (std::size_t k = count_; k-- > 0;) {
      pairs_[k].alpha = pairs_[k].rho * pairs_[k].step.dot(x);
      x -= pairs_[k].alpha * pairs_[k].change;
    }
    solve(x);
    for (std::size_t k = 0; k < count_; ++k)
      x += (pairs_[k].alpha - pairs_[k].rho * pairs_[k].change.dot(x)) * pairs_[k].step;
  }

 private:
  struct Pair {
    Eigen::VectorXd step, change;
    double rho = 0.0, alpha = 0.0;
  };
  std::array<Pair, 6> pairs_;
  std::size_t count_ = 0;
};

}  // namespace rigcal::graph
