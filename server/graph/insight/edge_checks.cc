#include "server/graph/insight/edge_checks.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "server/math/covariance.h"
#include "server/math/statistics.h"

namespace rigcal::graph {
namespace {

// Below this share of an edge's own variance nothing checks a direction: the solution follows the edge.
constexpr double kCheckedRatio = 1e-6;

// J P J^T of both ends.
Matrix6d PredictionOf(const Constraint& c, const EdgeJacobian& jacobian, const Eigen::MatrixXd& P) {
  Matrix6d S = Matrix6d::Zero();
  const int i = 6 * (c.i - 1), j = 6 * (c.j - 1);
  if (c.i > 0) S += jacobian.J_i * P.block<6, 6>(i, i) * jacobian.J_i.transpose();
  if (c.j > 0) S += jacobian.J_j * P.block<6, 6>(j, j) * jacobian.J_j.transpose();
  if (c.i > 0 && c.j > 0) {
    const Matrix6d cross = jacobian.J_i * P.block<6, 6>(i, j) * jacobian.J_j.transpose();
    S += cross + cross.transpose();
  }
  return Symmetrized(S);
}

void Test(const Matrix6d& Omega, bool counts, EdgeCheck& check) {
  const Matrix6d root = SquareRoot(Omega);  // whitens by the edge's own covariance; its null space drops out
  const Vector6d white = root.transpose() * check.jacobian.e;
  const Matrix6d C = root.transpose() * check.C_prediction * root;
  const Eigen::SelfAdjointEigenSolver<Matrix6d> own(Symmetrized(C));
  const Vector6d parts = own.eigenvectors().transpose() * white;
  const double information_min = 1e-12 * (root.transpose() * root).diagonal().maxCoeff();
  for (int k = 0; k < 6; ++k) {
    // Whitened, the edge's own covariance is the identity on what it sees.
    if ((root * own.eigenvectors().col(k)).squaredNorm() <= information_min) continue;
    const double variance = counts ? 1.0 - own.eigenvalues()(k) : 1.0 + own.eigenvalues()(k);
    if (!(variance > kCheckedRatio)) continue;
    ++check.rank;
    check.t_squared += parts(k) * parts(k) / variance;
  }
}

constexpr double kWeightLeast = 1e-8;  // of a rejected edge: keeps H regular, moves nothing
constexpr double kMuFactor = 1.4;
constexpr int kGncStepsMax = 100, kInnerIterations = 10, kOuterIterations = 100;
constexpr int kChangesMax =
    200;  // of sides: more edges than that contradict each other only where information is wrong

constexpr double kProbability = 0.999;  // of all edges together passing where all are good

class Robust {
 public:
  Robust(const Problem& problem, const Poses& start, RobustOptimum& result)
      : problem_(problem),
        weighted_(problem),
        cholesky_(MakeCholesky<6>(problem.pattern)),
        pins_(Observe(problem, start).pins),
        result_(result) {
    result_.T_ref = start;
    result_.kept.assign(problem.constraints.size(), true);
  }

  void Run() {
    if (cholesky_ == nullptr || !Check()) return;
    if (Worst() < problem_.constraints.size()) {
      Graduate();
      if (!Optimize(kOuterIterations) || !Check() || !Separate()) return;
    }
    result_.available = true;
  }

 private:
  [[nodiscard]] double Ratio(std::size_t k) const { return result_.checks.edges[k].t_squared / result_.limit[k]; }
  [[nodiscard]] double Squared(std::size_t k) const {
    const Vector6d e = Residual(problem_.constraints[k], result_.T_ref);
    return e.dot(problem_.constraints[k].Omega * e) / result_.limit[k];
  }

  void Weigh(std::size_t k, double weight) {
    weighted_.constraints[k].Omega = std::max(weight, kWeightLeast) * problem_.constraints[k].Omega;
  }

  bool Optimize(int iterations_max) {
    const Optimum optimum = graph::Optimize(weighted_, result_.T_ref, pins_, *cholesky_, iterations_max);
    result_.T_ref = optimum.T_ref;
    return std::isfinite(optimum.cost);
  }

  bool Check() {
    NormalEquations equations;
    Linearize(weighted_, result_.T_ref, equations);
    AddPins(pins_, equations.H);
    if (!cholesky_->Factor(equations.H, 0.0)) return false;
    result_.checks = CheckEdges(problem_, result_.T_ref, result_.kept, *cholesky_);
    return true;
  }

  // Weight of truncated least squares at a squared residual in units of its limit.
  static double GncWeight(double squared, double mu) {
    if (squared >= (mu + 1.0) / mu) return 0.0;
    if (squared <= mu / (mu + 1.0)) return 1.0;
    return std::sqrt(mu * (mu + 1.0) / squared) - mu;
  }

  void Graduate() {
    double largest = 0.0;
    for (std::size_t k = 0; k < result_.kept.size(); ++k) largest = std::max(largest, Squared(k));
    double mu = largest > 1.0 ? 1.0 / (2.0 * largest - 1.0) : 1.0;
    for (int step = 0; step < kGncStepsMax; ++step, mu *= kMuFactor) {
      bool decided = true;
      for (std::size_t k = 0; k < result_.kept.size(); ++k) {
        const double weight = GncWeight(Squared(k), mu);
        decided = decided && (weight == 0.0 || weight == 1.0);
        result_.kept[k] = weight > 0.5;
        Weigh(k, weight);
      }
      if (!Optimize(kInnerIterations) || decided) break;
    }
    for (std::size_t k = 0; k < result_.kept.size(); ++k) Weigh(k, result_.kept[k] ? 1.0 : 0.0);
  }

  // The kept edge furthest beyond its limit; the count if there is none.
  [[nodiscard]] std::size_t Worst() const {
    std::size_t worst = result_.kept.size();
    for (std::size_t k = 0; k < result_.kept.size(); ++k)
      if (result_.kept[k] && Ratio(k) > 1.0 && (worst == result_.kept.size() || Ratio(k) > Ratio(worst))) worst = k;
    return worst;
  }

  // The rejected edge that fits best, if it fits and was not taken back before.
  [[nodiscard]] std::size_t BestRejected(const std::vector<bool>& taken_back) const {
    std::size_t best = result_.kept.size();
    for (std::size_t k = 0; k < result_.kept.size(); ++k)
      if (!result_.kept[k] && !taken_back[k] && Ratio(k) <= 1.0 &&
          (best == result_.kept.size() || Ratio(k) < Ratio(best)))
        best = k;
    return best;
  }

  // One edge at a time changes sides, back at most once each. False if it does not come to rest.
  bool Separate() {
    std::vector<bool> taken_back(result_.kept.size(), false);
    for (int change = 0; change < kChangesMax; ++change) {
      std::size_t k = BestRejected(taken_back);
      if (k < result_.kept.size()) {
        taken_back[k] = true;
      } else {
        k = Worst();
        if (k == result_.kept.size()) return true;
      }
      result_.kept[k] = !result_.kept[k];
      Weigh(k, result_.kept[k] ? 1.0 : 0.0);
      if (!Optimize(kOuterIterations) || !Check()) return false;
    }
    return false;
  }

  const Problem& problem_;
  Problem weighted_;
  std::unique_ptr<BlockCholesky<6>> cholesky_;
  std::vector<Pin> pins_;
  RobustOptimum& result_;
};

// Limit of T^2: chi-square where the covariance is known, Hotelling's where it was estimated.
double LimitOf(const Constraint& constraint, int dof, std::size_t edge_count) {
  const double each = 1.0 - (1.0 - kProbability) / static_cast<double>(std::max<std::size_t>(edge_count, 1));
  return dof > 0 ? HotellingLimit(dof + 1, constraint.rank, each) : ChiSquareQuantile(each, constraint.rank);
}

}  // namespace

EdgeChecks CheckEdges(const Problem& problem, const Poses& T_ref, const std::vector<bool>& counts,
                      BlockCholesky<6>& cholesky) {
  EdgeChecks checks;
  const Eigen::Index n = 6 * problem.free_count();
  checks.P = Eigen::MatrixXd::Identity(n, n);
  cholesky.SolveInPlace(checks.P);
  checks.edges.resize(problem.constraints.size());
  for (std::size_t k = 0; k < checks.edges.size(); ++k) {
    EdgeCheck& check = checks.edges[k];
    check.jacobian = JacobianOf(problem.constraints[k], T_ref);
    check.C_prediction = PredictionOf(problem.constraints[k], check.jacobian, checks.P);
    Test(problem.constraints[k].Omega, counts[k], check);
  }
  return checks;
}

RobustOptimum OptimizeRobustly(const Problem& problem, const Poses& start, const std::vector<int>& dof) {
  RobustOptimum result;
  if (problem.free_count() == 0 || problem.free_count() >= kChecksSensorsMax) return result;
  for (std::size_t k = 0; k < problem.constraints.size(); ++k)
    result.limit.push_back(LimitOf(problem.constraints[k], dof[k], problem.constraints.size()));
  Robust(problem, start, result).Run();
  return result;
}

}  // namespace rigcal::graph
