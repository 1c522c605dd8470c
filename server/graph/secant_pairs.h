// What the steps taken since the last factorisation tell about the Hessian that the factor does not know: limited-
// memory BFGS (Nocedal 1980, the two-loop recursion) with the factor as its starting matrix.
#pragma once

#include <Eigen/Core>
#include <array>

namespace rigcal::graph {

class SecantPairs {
 public:
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
