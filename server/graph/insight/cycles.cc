#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <tuple>

#include "server/graph/insight/cycle_walks.h"
#include "server/graph/insight/insight.h"
#include "server/graph/uncertainty/graph_jackknife.h"
#include "server/math/covariance.h"
#include "server/math/statistics.h"
#include "server/model/sessions/session_estimate.h"

namespace rigcal::graph {
namespace {

using Eigen::MatrixXd;

constexpr double kDofMax = 1e6, kDofRounding = 1e-6;
constexpr double kProbability = 0.999;  // that all cycles of a graph of good edges close
// What edges leave open is known to a metre and a radian: axes of two edges that should be one differ by their noise,
// and what is measured across both is hidden by as much of a metre only.
constexpr double kOpenSigma = 1.0;
// A residual is tested where its edges measure at least that share of its variance, or know it all the same to that, in
// m and rad.
constexpr double kMeasuredShare = 0.5, kKnownTo = 0.1;

using Columns = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 6>;

// What one edge errs by, column by column, and which cause each part belongs to.
struct Causes {
  struct Part {
    std::size_t source = 0;
    int dof = 0;
    MatrixXd d;  // right tangent of the measurement
  };
  std::vector<std::vector<Part>> of_constraint;
  std::vector<bool> own_known;  // by constraint
  std::size_t shared_count = 0;
};

class Judge {
 public:
  Judge(const Graph& graph, const Problem& problem, const BlocksByEdge& blocks)
      : work_{graph, problem, blocks, {}}, seen_(problem.constraints.size()) {
    work_.jacobians.resize(problem.constraints.size());
    for (EdgeJacobian& jacobian : work_.jacobians) jacobian.D = Matrix6d::Identity();  // causes as the edges have them
    TakeShared();
  }

  CycleResidual Residual(const Walk& walk) {
    CycleResidual cycle;
    for (const WalkStep& step : walk) {
      cycle.edges.push_back(work_.EdgeOf(step.constraint).id);
      cycle.sensors.push_back(SensorAt(StartOf(work_.problem, step)));
    }
    const std::vector<Matrix6d> carry = Carry(walk, cycle.e);
    Test(walk, carry, cycle);
    return cycle;
  }

 private:
  void TakeShared() {
    causes_.of_constraint.resize(work_.problem.constraints.size());
    causes_.own_known.assign(work_.problem.constraints.size(), false);
    std::vector<ErrorSource> shared = SharedSourcesOf(work_);
    causes_.shared_count = shared.size();
    for (std::size_t s = 0; s < shared.size(); ++s)
      for (ErrorPart& part : shared[s].parts)
        causes_.of_constraint[part.constraint].push_back({s, shared[s].dof, std::move(part.de)});
  }

  const std::vector<Causes::Part>& CausesOf(std::size_t k) {
    if (!causes_.own_known[k]) {
      ErrorSource own = OwnSourceOf(work_, k);
      if (own.column_count > 0)
        causes_.of_constraint[k].push_back({causes_.shared_count + k, own.dof, std::move(own.parts[0].de)});
      causes_.own_known[k] = true;
    }
    return causes_.of_constraint[k];
  }

  const ObservableSubspace& SeenBy(std::size_t k) {
    if (!seen_[k]) seen_[k] = Observable(work_.problem.constraints[k].Omega);
    return *seen_[k];
  }

  [[nodiscard]] const SensorId& SensorAt(int vertex) const {
    return work_.graph.sensors[work_.problem.sensor_of_vertex[static_cast<std::size_t>(vertex)]];
  }

  // What an error of each step's measurement does to the loop's residual. (The residual's own Jacobian leaves e and
  // thereby T^2 as they are.)
  std::vector<Matrix6d> Carry(const Walk& walk, Vector6d& e) const {
    std::vector<Matrix6d> carry(walk.size());
    Se3 T_after;  // of the steps behind this one
    for (std::size_t n = walk.size(); n-- > 0;) {
      const Constraint& c = work_.problem.constraints[walk[n].constraint];
      const Matrix6d A = Adjoint(T_after.Inverse());
      carry[n] = walk[n].forward ? A : Matrix6d(-A * Adjoint(c.T_i_j));
      T_after = ((walk[n].forward ? c.T_i_j : c.T_j_i) * T_after).Normalized();
    }
    e = T_after.Log();
    return carry;
  }

  // Of a residual: what its edges measure, and what they leave open.
  struct Variances {
    Matrix6d measured = Matrix6d::Zero(), open = Matrix6d::Zero();
    bool any_open = false;
  };
  // Residuals by their sigma, without those in which what is open tells most: w = columns^T L^-1 e, C = L L^T.
  struct Tested {
    Eigen::LLT<Matrix6d> sigma;
    Columns columns = Matrix6d::Identity();
    Eigen::VectorXd open = Eigen::VectorXd::Zero(6);  // share of the variance

    [[nodiscard]] MatrixXd Whitened(const MatrixXd& e) const { return columns.transpose() * sigma.matrixL().solve(e); }
    // Without what lies along what is open, as far as that is told best.
    [[nodiscard]] Vector6d PartOf(const Vector6d& e) const { return sigma.matrixL() * (columns * Whitened(e)).eval(); }
  };

  static Tested TestedOf(const Variances& variances) {
    Tested tested{Eigen::LLT<Matrix6d>(variances.measured + variances.open)};
    if (!variances.any_open || tested.sigma.info() != Eigen::Success) return tested;
    const Matrix6d half = tested.sigma.matrixL().solve(variances.measured);
    const Matrix6d share = tested.sigma.matrixL().solve(half.transpose().eval());
    const Eigen::SelfAdjointEigenSolver<Matrix6d> parts(Symmetrized(share));
    tested.columns.resize(6, 0), tested.open.resize(0);
    for (int k = 0; k < 6; ++k) {
      const Vector6d column = parts.eigenvectors().col(k);
      const double measured = parts.eigenvalues()(k);
      const double known_to = 1.0 / tested.sigma.matrixU().solve(column).norm();
      if (measured < kMeasuredShare && known_to > kKnownTo) continue;
      tested.columns.conservativeResize(6, tested.columns.cols() + 1);
      tested.columns.rightCols<1>() = column;
      tested.open.conservativeResize(tested.columns.cols());
      tested.open.tail<1>().setConstant(std::max(0.0, 1.0 - measured));
    }
    return tested;
  }

  void Test(const Walk& walk, const std::vector<Matrix6d>& carry, CycleResidual& cycle) {
    std::vector<Causes::Part> sums;  // per cause: what it does to the loop
    Variances variances;
    for (std::size_t n = 0; n < walk.size(); ++n) {
      for (const Causes::Part& part : CausesOf(walk[n].constraint)) {
        const auto same =
            std::find_if(sums.begin(), sums.end(), [&](const Causes::Part& sum) { return sum.source == part.source; });
        if (same == sums.end()) {
          sums.push_back({part.source, part.dof, carry[n] * part.d});
        } else {
          same->d += carry[n] * part.d;
        }
      }
      const ObservableSubspace& seen = SeenBy(walk[n].constraint);
      variances.measured += carry[n] * seen.covariance * carry[n].transpose();
      if (work_.problem.constraints[walk[n].constraint].rank == 6) continue;
      const MatrixXd open = kOpenSigma * carry[n] * seen.unobservable_basis;
      variances.open += open * open.transpose();
      variances.any_open = true;
    }
    variances.measured = Symmetrized(variances.measured), variances.open = Symmetrized(variances.open);
    Compare(variances, sums, cycle);
  }

  void Compare(const Variances& variances, const std::vector<Causes::Part>& sums, CycleResidual& cycle) const {
    const Tested tested = TestedOf(variances);
    const Eigen::Index count = tested.columns.cols();
    cycle.tested = tested.sigma.info() == Eigen::Success && count > 0;
    if (!cycle.tested) return;
    Vector6d e = Vector6d::Zero();  // of as many directions as are tested; the others stay zero
    e.head(count) = tested.Whitened(cycle.e);
    if (count < 6) cycle.e = tested.PartOf(cycle.e);
    Matrix6d C = Matrix6d::Zero();
    C.topLeftCorner(count, count).diagonal() = tested.open;
    double trace = 0.0, dof_sum = 0.0;
    for (const Causes::Part& sum : sums) {
      const MatrixXd white = tested.Whitened(sum.d);
      C.topLeftCorner(count, count) += white * white.transpose();
      trace += white.squaredNorm();
      if (sum.dof > 0) dof_sum += white.squaredNorm() * white.squaredNorm() / sum.dof;
    }
    cycle.dof = dof_sum > 0.0 ? trace * trace / dof_sum : 0.0;
    const bool shared = std::any_of(sums.begin(), sums.end(),
                                    [&](const Causes::Part& sum) { return sum.source < causes_.shared_count; });
    const CheckedDirections checked =
        shared ? CheckWhitened(C, e)
               : CheckedDirections{static_cast<int>(count), e.squaredNorm()};  // else C is the identity
    cycle.rank = checked.rank, cycle.t_squared = checked.t_squared;
    cycle.tested = cycle.rank > 0 && std::isfinite(cycle.t_squared);
    if (!cycle.tested) cycle.t_squared = cycle.dof = cycle.rank = 0;
  }

  JackknifeWork work_;
  Causes causes_;
  std::vector<std::optional<ObservableSubspace>> seen_;  // by constraint
};

// Per cycle, so that all of them together pass with kProbability where every edge is good.
class Limits {
 public:
  explicit Limits(std::int64_t count)
      : each_(1.0 - (1.0 - kProbability) / static_cast<double>(std::max<std::int64_t>(count, 1))) {}

  double Of(const CycleResidual& cycle) {
    const int dof = cycle.dof > 0.0 ? static_cast<int>(std::min(cycle.dof, kDofMax) + kDofRounding) : -1;
    const auto [at, is_new] = known_.try_emplace({dof, cycle.rank}, 0.0);
    if (!is_new) return at->second;
    const double limit = dof < 0 ? ChiSquareQuantile(each_, cycle.rank) : HotellingLimit(dof + 1, cycle.rank, each_);
    return at->second = std::isfinite(limit) ? limit : 0.0;
  }

 private:
  double each_;
  std::map<std::pair<int, int>, double> known_;  // by degrees of freedom and rank: many cycles have the same
};

bool WorseThan(const CycleResidual& a, const CycleResidual& b) {
  const auto key = [](const CycleResidual& cycle) {
    const double ratio = cycle.limit > 0.0 ? cycle.t_squared / cycle.limit : -1.0;
    return std::make_tuple(-ratio, -cycle.e.head<3>().norm());
  };
  return key(a) != key(b) ? key(a) < key(b) : a.edges < b.edges;
}

// Many loops may fail by a hair that is beyond chance: of the `failing` first that which is most open is the last one
// kept.
void KeepMostOpen(std::size_t kept, std::int64_t failing, std::vector<CycleResidual>& cycles) {
  if (kept == 0 || failing <= static_cast<std::int64_t>(kept)) return;
  const auto openness = [](const CycleResidual& cycle) {
    return std::max(cycle.e.head<3>().norm() / kMovedMin_m, cycle.e.tail<3>().norm() / kMovedMin_rad);
  };
  const auto most = std::max_element(cycles.begin(), cycles.begin() + failing,
                                     [&](const auto& a, const auto& b) { return openness(a) < openness(b); });
  const auto last = cycles.begin() + static_cast<std::ptrdiff_t>(kept) - 1;
  if (most > last) std::iter_swap(most, last);
}

void KeepWorst(std::vector<CycleResidual>& cycles, const CycleOptions& options, Cycles& judged) {
  judged.examined = static_cast<std::int64_t>(cycles.size());
  Limits limits(std::count_if(cycles.begin(), cycles.end(), [](const auto& cycle) { return cycle.tested; }));
  for (CycleResidual& cycle : cycles) {
    if (cycle.tested) cycle.limit = limits.Of(cycle);
    judged.tested += cycle.limit > 0.0 ? 1 : 0;
    judged.failing += cycle.fails() ? 1 : 0;
  }
  std::sort(cycles.begin(), cycles.end(), WorseThan);
  KeepMostOpen(options.worst_max, judged.failing, cycles);
  const auto kept = static_cast<std::ptrdiff_t>(std::min(cycles.size(), options.worst_max));
  std::copy_if(cycles.begin() + kept, cycles.end(), std::back_inserter(judged.others),
               [](const CycleResidual& cycle) { return cycle.tested; });
  cycles.resize(static_cast<std::size_t>(kept));
  judged.worst = std::move(cycles);
}

}  // namespace

Cycles JudgeCycles(const Graph& graph, const BlocksByEdge& blocks, const CycleOptions& options) {
  Cycles judged;
  const Problem problem = MakeProblem(graph);
  if (!blocks.empty() && problem.free_count() >= kJackknifeSensorsMax) {
    judged.why_not = "Loops were left out: over shared captures they are worked out up to " +
                     std::to_string(kJackknifeSensorsMax) + " sensors, and this graph has " +
                     std::to_string(problem.vertex_count) + ".";
    return judged;
  }
  const CycleWalks found = WalksOf(problem, options.steps_max);
  Judge judge(graph, problem, blocks);
  std::vector<CycleResidual> cycles;
  for (const Walk& walk : found.walks) cycles.push_back(judge.Residual(walk));
  judged.judged = true;
  if (!found.complete)
    judged.why_not = "Longer loops were left out: the first " + std::to_string(found.walks.size()) +
                     " were worked out, those over the surest edges, " + std::to_string(options.steps_max) +
                     " steps in all.";
  KeepWorst(cycles, options, judged);
  return judged;
}

}  // namespace rigcal::graph
