#include "server/graph/gauss_newton.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rigcal::graph {
namespace {

constexpr double kCostRelative = 1e-14;
constexpr double kStep = 1e-12;
constexpr double kRoundingRelative = 1e-12;  // of the cost: below this a rise is rounding, not a wrong step
constexpr double kLambdaFirst = 1e-6, kLambdaMax = 1e12, kLambdaFactor = 10.0;
constexpr double kLambdaTrusted = 1e-3;      // a short step under heavier damping says nothing

// One descent. Owns all the memory it needs, so that its loop allocates nothing.
class Descent {
 public:
  Descent(const Problem& problem, const std::vector<Pin>& pins, BlockCholesky<6>& cholesky, const Poses& start)
      : problem_(problem), pins_(pins), cholesky_(cholesky), T_ref_(start), trial_(start) {
    Prepare(T_ref_, equations_);
  }

  Optimum Run(int iterations_max) {
    Optimum optimum;
    while (!optimum.converged && optimum.iterations < iterations_max && lambda_ <= kLambdaMax) {
      ++optimum.iterations;
      optimum.converged = Iterate();
    }
    optimum.T_ref = std::move(T_ref_);
    optimum.cost = equations_.cost;
    optimum.converged = optimum.converged && std::isfinite(optimum.cost);
    return optimum;
  }

 private:
  void Prepare(const Poses& T_ref, NormalEquations& equations) {
    Linearize(problem_, T_ref, equations);
    AddPins(pins_, equations.H);
  }

  // True once nothing is left to gain.
  bool Iterate() {
    if (!cholesky_.Factor(equations_.H, lambda_)) return Damp();
    step_ = -equations_.g;
    cholesky_.SolveInPlace(step_);
    if (!step_.allFinite()) return Damp();
    const double gain = -step_.dot(equations_.g) + lambda_ * DampedLength();
    const bool small = gain <= kCostRelative * equations_.cost || step_.cwiseAbs().maxCoeff() <= kStep;
    const bool last = small && lambda_ <= kLambdaTrusted;
    Retract(T_ref_, step_, trial_);
    Prepare(trial_, trial_equations_);
    if (!Improves(gain)) return last || Damp();
    std::swap(T_ref_, trial_);
    std::swap(equations_, trial_equations_);
    lambda_ = lambda_ <= kLambdaFirst ? 0.0 : lambda_ / kLambdaFactor;
    return last;
  }

  [[nodiscard]] bool Improves(double gain) const {
    const double cost = trial_equations_.cost;
    if (!std::isfinite(cost)) return false;
    if (cost < equations_.cost) return true;
    return gain <= kRoundingRelative * equations_.cost && cost <= (1.0 + kRoundingRelative) * equations_.cost;
  }

  // dx^T diag(H) dx, which the damping adds to the model's gain.
  [[nodiscard]] double DampedLength() const {
    if (lambda_ == 0.0) return 0.0;
    double length = 0.0;
    for (int v = 0; v < problem_.free_count(); ++v) {
      const Vector6d part = step_.segment<6>(6 * v);
      length += part.dot(equations_.H.diagonal[static_cast<std::size_t>(v)].diagonal().cwiseProduct(part));
    }
    return length;
  }

  bool Damp() {
    lambda_ = std::max(lambda_ * kLambdaFactor, kLambdaFirst);
    return false;
  }

  const Problem& problem_;
  const std::vector<Pin>& pins_;
  BlockCholesky<6>& cholesky_;
  Poses T_ref_, trial_;
  NormalEquations equations_, trial_equations_;
  Eigen::VectorXd step_;
  double lambda_ = 0.0;
};

}  // namespace

void AddPins(const std::vector<Pin>& pins, BlockMatrix<6>& H) {
  if (pins.empty()) return;
  double trace = 0.0;
  for (const Matrix6d& block : H.diagonal) trace += block.trace();
  const double typical = trace > 0.0 ? trace / (6.0 * static_cast<double>(H.diagonal.size())) : 1.0;
  for (const Pin& pin : pins) {
    double& entry = H.diagonal[static_cast<std::size_t>(pin.row / 6)](pin.row % 6, pin.row % 6);
    entry += std::max(entry, 1e-9 * typical);
  }
}

Optimum Optimize(const Problem& problem, const Poses& start, const std::vector<Pin>& pins, BlockCholesky<6>& cholesky,
                 int iterations_max) {
  if (problem.free_count() == 0) return {start, Cost(problem, start), 0, true};
  return Descent(problem, pins, cholesky, start).Run(iterations_max);
}

}  // namespace rigcal::graph
