#include "server/graph/solve/gauss_newton.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/graph/solve/conjugate_gradients.h"

namespace rigcal::graph {
namespace {

constexpr double kCostRelative = 1e-14;
constexpr double kStep = 1e-12;
constexpr double kRoundingRelative = 1e-12;  // of the cost: below this a rise is rounding, not a wrong step
constexpr double kLambdaFirst = 1e-6, kLambdaMax = 1e12, kLambdaFactor = 10.0, kLambdaLeast = 1e-9;
constexpr double kLambdaTrusted = 1e-3;  // a short step under heavier damping says nothing
constexpr int kClimbsMax = 2;
// Of what the coordinate has. Where edges leave open nearly the same direction, but not quite, the descent would creep
// along what they seem to say of it.
constexpr double kPinRatio = 1e6;
constexpr double kStepReuse = 0.05;      // m and rad
constexpr double kGainReuse = 0.1;       // as long as each step gains this much less than the one before
constexpr double kShrinkLeast = 1e-4;    // one good step does not promise that the next shrinks as well
constexpr double kRestRelative = 5e-15;  // of the cost: left to gain after a step, if gains go on shrinking as they did

// One descent. Owns all the memory it needs, so that its loop allocates nothing.
//
// A full Gauss-Newton step along a soft direction may climb before the next one lands far below (long chains: every
// such graph). So up to kClimbsMax undamped steps may go uphill in a row; if they do not end below the best point, the
// descent returns to it and damps.
class Descent {
 public:
  Descent(const Problem& problem, const std::vector<Pin>& pins, BlockCholesky<6>& cholesky, const Poses& start)
      : problem_(problem),
        pins_(pins),
        cholesky_(cholesky),
        T_ref_(start),
        best_T_ref_(start),
        trial_(start),
        rough_(problem.free_count() <= kBlocksDenseMax || PrefersConjugateGradients(problem)) {
    Prepare();
    best_cost_ = equations_.cost;
  }

  Optimum Run(int iterations_max) {
    Optimum optimum;
    while (!optimum.converged && optimum.iterations < iterations_max && lambda_ <= kLambdaMax) {
      ++optimum.iterations;
      optimum.converged = Iterate();
    }
    optimum.T_ref = std::move(best_T_ref_);
    optimum.residuals = std::move(residuals_);
    optimum.cost = best_cost_;
    optimum.converged = optimum.converged && std::isfinite(best_cost_);
    return optimum;
  }

 private:
  void Prepare() {
    if (reuse_factor_) {
      LinearizeGradient(problem_, T_ref_, equations_);
    } else {
      if (std::exchange(rough_, false))
        LinearizeRoughly(problem_, T_ref_, equations_);
      else
        Linearize(problem_, T_ref_, equations_);
      AddPins(pins_, equations_.H);
    }
    for (const Pin& pin : pins_) equations_.g[pin.row] = 0.0;
  }

  // True once nothing is left to gain.
  bool Iterate() {
    const bool reused = reuse_factor_;
    if (!reused && !cholesky_.Factor(equations_.H, lambda_)) return Damp();
    if (!reused) secants_.Clear();
    step_ = -equations_.g;
    secants_.Apply(step_, [this](Eigen::VectorXd& x) { cholesky_.SolveInPlace(x); });
    if (!step_.allFinite()) return Damp();
    const double gain = -step_.dot(equations_.g) + lambda_ * DampedLength();
    const bool small =
        gain <= kCostRelative * equations_.cost || step_.cwiseAbs().maxCoeff() <= kStep || LeavesNothing(gain);
    const bool last = small && lambda_ <= kLambdaTrusted && climbs_ == 0;
    reuse_factor_ =
        lambda_ == 0.0 && step_.cwiseAbs().maxCoeff() <= kStepReuse && (!reused || gain < kGainReuse * gain_);
    gain_ = gain;
    Retract(T_ref_, step_, trial_);
    std::swap(T_ref_, trial_);
    if (last) {
      residuals_ = Residuals(problem_, T_ref_);
      equations_.cost = Cost(problem_, residuals_);
    } else {
      g_before_ = equations_.g;
      Prepare();
      if (reuse_factor_) secants_.Remember(step_, equations_.g - g_before_);
    }
    if (Improves(gain)) return Keep(last);
    residuals_.clear();
    if (last) return true;
    return climbs_ < kClimbsMax && lambda_ == 0.0 && std::isfinite(equations_.cost) ? Climb() : Damp();
  }

  // Gains shrink at least geometrically near the optimum: what the steps after this one would still gain is nothing.
  [[nodiscard]] bool LeavesNothing(double gain) const {
    return gain_ > 0.0 && gain < kGainReuse * gain_ &&
           gain * std::max(gain / gain_, kShrinkLeast) <= kRestRelative * equations_.cost;
  }

  [[nodiscard]] bool Improves(double gain) const {
    if (!std::isfinite(equations_.cost)) return false;
    if (equations_.cost < best_cost_) return true;
    return gain <= kRoundingRelative * best_cost_ && equations_.cost <= (1.0 + kRoundingRelative) * best_cost_;
  }

  bool Keep(bool last) {
    best_T_ref_ = T_ref_;
    best_cost_ = equations_.cost;
    climbs_ = 0;
    lambda_ = lambda_ <= kLambdaLeast ? 0.0 : lambda_ / kLambdaFactor;
    return last;
  }

  bool Climb() {
    ++climbs_;
    if (reuse_factor_) {
      reuse_factor_ = false;
      Prepare();
    }
    return false;
  }

  bool Damp() {
    lambda_ = std::max(lambda_ * kLambdaFactor, kLambdaFirst);
    climbs_ = 0;
    gain_ = 0.0;
    reuse_factor_ = false;
    T_ref_ = best_T_ref_;
    Prepare();
    return false;
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

  const Problem& problem_;
  const std::vector<Pin>& pins_;
  BlockCholesky<6>& cholesky_;
  Poses T_ref_, best_T_ref_, trial_;
  NormalEquations equations_;  // at T_ref_
  double best_cost_ = 0.0;
  Eigen::VectorXd step_, g_before_;
  std::vector<Vector6d> residuals_;  // after the last step, if it was kept
  SecantPairs secants_;
  double lambda_ = 0.0;
  double gain_ = 0.0;          // of the step before; 0: none to compare with
  bool reuse_factor_ = false;  // H barely changes over short steps: the old factor finds the same optimum
  bool rough_ = false;         // for the first step, where a start is fair or a factor costs little
  int climbs_ = 0;
};

}  // namespace

void AddPins(const std::vector<Pin>& pins, BlockMatrix<6>& H) {
  if (pins.empty()) return;
  double trace = 0.0;
  for (const Matrix6d& block : H.diagonal) trace += block.trace();
  const double typical = trace > 0.0 ? trace / (6.0 * static_cast<double>(H.diagonal.size())) : 1.0;
  for (const Pin& pin : pins) {
    double& entry = H.diagonal[static_cast<std::size_t>(pin.row / 6)](pin.row % 6, pin.row % 6);
    entry += kPinRatio * std::max(entry, 1e-9 * typical);
  }
}

Optimum Optimize(const Problem& problem, const Poses& start, const std::vector<Pin>& pins, BlockCholesky<6>& cholesky,
                 int iterations_max) {
  if (problem.free_count() == 0) return {start, {}, Cost(problem, start), 0, true};
  return Descent(problem, pins, cholesky, start).Run(iterations_max);
}

}  // namespace rigcal::graph
