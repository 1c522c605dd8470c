#include <Eigen/Cholesky>
#include <Eigen/SVD>
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
constexpr double kOpenRatio = 1e-6;     // directions that edges leave open are one where they differ by less

// Orthonormal columns: directions of a loop's residual.
using Directions = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 6>;

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
    const Directions measured = MeasuredByAll(walk, carry);
    cycle.tested = measured.cols() > 0;
    if (cycle.tested) Test(walk, carry, measured, cycle);
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

  // At right angles to what any step leaves open, in m and rad: what it holds there is nobody's measurement.
  Directions MeasuredByAll(const Walk& walk, const std::vector<Matrix6d>& carry) {
    MatrixXd open(6, 0);
    for (std::size_t n = 0; n < walk.size(); ++n) {
      if (work_.problem.constraints[walk[n].constraint].rank == 6) continue;
      const MatrixXd own = (carry[n] * SeenBy(walk[n].constraint).unobservable_basis).colwise().normalized();
      open.conservativeResize(6, open.cols() + own.cols());
      open.rightCols(own.cols()) = own;
    }
    if (open.cols() == 0) return Matrix6d::Identity();
    const Eigen::JacobiSVD<MatrixXd> svd(open, Eigen::ComputeFullU);
    const auto open_rank = (svd.singularValues().array() > kOpenRatio * svd.singularValues()(0)).count();
    return svd.matrixU().rightCols(6 - open_rank);
  }

  void Test(const Walk& walk, const std::vector<Matrix6d>& carry, const Directions& measured, CycleResidual& cycle) {
    std::vector<Causes::Part> sums;  // per cause: what it does to the loop
    Matrix6d C_independent = Matrix6d::Zero();
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
      C_independent += carry[n] * SeenBy(walk[n].constraint).covariance * carry[n].transpose();
    }
    Compare(Symmetrized(C_independent), sums, measured, cycle);
  }

  void Compare(const Matrix6d& C_independent, const std::vector<Causes::Part>& sums, const Directions& measured,
               CycleResidual& cycle) const {
    const Eigen::Index count = measured.cols();
    const Eigen::LLT<MatrixXd> whiten(measured.transpose() * C_independent * measured);
    cycle.tested = whiten.info() == Eigen::Success;
    if (!cycle.tested) return;
    Vector6d e = Vector6d::Zero();  // whitened, of as many directions as are measured; the others stay zero
    e.head(count) = whiten.matrixL().solve(measured.transpose() * cycle.e);
    if (count < 6) cycle.e = measured * (measured.transpose() * cycle.e).eval();
    Matrix6d C = Matrix6d::Zero();
    double trace = 0.0, dof_sum = 0.0;
    for (const Causes::Part& sum : sums) {
      const MatrixXd white = whiten.matrixL().solve(measured.transpose() * sum.d);
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
