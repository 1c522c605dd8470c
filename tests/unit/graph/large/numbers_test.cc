// The numerical core against oracles that share none of its formulas: finite differences, Ceres's automatic
// differentiation, dense inverses.
#include <gtest/gtest.h>

#include <Eigen/LU>

#include "server/graph/solve/gauss_newton.h"
#include "server/graph/solve/start_poses.h"
#include "tests/unit/graph/ceres.h"
#include "tests/unit/graph/fixture.h"

namespace rigcal::graph {
namespace {

Poses Perturbed(const Problem& problem, unsigned seed, double size) {
  std::mt19937 random(seed);
  Poses T_ref = SpanningTreePoses(problem);
  for (std::size_t v = 1; v < T_ref.size(); ++v) T_ref[v] = T_ref[v] * Se3::Exp(RandomVector(random, size, size));
  return T_ref;
}

TEST(GraphLinearize, GradientMatchesFiniteDifferencesFarFromZeroResidual) {
  const Problem problem = MakeProblem(MakeRig(5, 9, 20, 0.5, 0.5).graph);
  const Poses T_ref = Perturbed(problem, 21, 0.4);
  NormalEquations equations;
  Linearize(problem, T_ref, equations);
  ASSERT_GT(equations.cost, 1.0);
  EXPECT_NEAR(equations.cost, Cost(problem, T_ref), 1e-9 * equations.cost);
  constexpr double kStep = 1e-5;
  for (int row = 0; row < equations.g.size(); ++row) {
    Eigen::VectorXd step = Eigen::VectorXd::Zero(equations.g.size());
    Poses plus, minus;
    step(row) = kStep;
    Retract(T_ref, step, plus);
    Retract(T_ref, -step, minus);
    const double slope = (Cost(problem, plus) - Cost(problem, minus)) / (2 * kStep);
    EXPECT_NEAR(2.0 * equations.g(row), slope, 1e-6 * equations.g.cwiseAbs().maxCoeff()) << row;
  }
}

// H = J^T Omega J with J by finite differences of the residuals.
TEST(GraphLinearize, HessianIsThatOfFiniteDifferenceJacobians) {
  const Problem problem = MakeProblem(MakeRig(4, 8, 22, 0.5, 0.5).graph);
  const Poses T_ref = Perturbed(problem, 23, 0.4);
  NormalEquations equations;
  Linearize(problem, T_ref, equations);
  const int size = 6 * problem.free_count();
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(size, size);
  for (const Constraint& constraint : problem.constraints) {
    Eigen::MatrixXd J(6, size);
    for (int row = 0; row < size; ++row) {
      Eigen::VectorXd step = Eigen::VectorXd::Zero(size);
      step(row) = 1e-6;
      Poses plus, minus;
      Retract(T_ref, step, plus);
      Retract(T_ref, -step, minus);
      J.col(row) = (Residual(constraint, plus) - Residual(constraint, minus)) / 2e-6;
    }
    H += J.transpose() * constraint.Omega * J;
  }
  for (int v = 0; v < problem.free_count(); ++v)
    EXPECT_LT((equations.H.diagonal[static_cast<std::size_t>(v)] - H.block<6, 6>(6 * v, 6 * v)).norm(),
              1e-6 * H.norm());
  for (std::size_t s = 0; s < problem.pattern.off_diagonal.size(); ++s) {
    const BlockPosition at = problem.pattern.off_diagonal[s];
    EXPECT_LT((equations.H.off_diagonal[s] - H.block<6, 6>(6 * at.row, 6 * at.col)).norm(), 1e-6 * H.norm());
  }
}

TEST(GraphChordal, IsExactForExactMeasurementsWhateverTheAngles) {
  const RandomRig rig = MakeRig(60, 150, 24, 1e-12, 1e-12, false);
  const Problem problem = MakeProblem(rig.graph);
  const std::optional<Poses> chordal = ChordalPoses(problem);
  ASSERT_TRUE(chordal.has_value());
  for (std::size_t v = 0; v < chordal->size(); ++v)
    EXPECT_LT(Distance((*chordal)[v], rig.truth[problem.sensor_of_vertex[v]]), 1e-9) << v;
}

// Dense and sparse factors of one random matrix, and their inverses' diagonal blocks against a dense LU inverse.
TEST(GraphCholesky, SparseAndDenseAgreeWithAnInverse) {
  const Problem problem = MakeProblem(MakeRig(120, 260, 25).graph);
  NormalEquations equations;
  Linearize(problem, SpanningTreePoses(problem), equations);
  const int size = 6 * problem.free_count();
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(size, size);
  for (int v = 0; v < problem.free_count(); ++v)
    H.block<6, 6>(6 * v, 6 * v) = equations.H.diagonal[static_cast<std::size_t>(v)];
  for (std::size_t s = 0; s < problem.pattern.off_diagonal.size(); ++s) {
    const BlockPosition at = problem.pattern.off_diagonal[s];
    H.block<6, 6>(6 * at.row, 6 * at.col) = equations.H.off_diagonal[s];
    H.block<6, 6>(6 * at.col, 6 * at.row) = equations.H.off_diagonal[s].transpose();
  }
  const Eigen::MatrixXd inverse = H.partialPivLu().inverse();
  for (const int dense_max : {0, 1000}) {
    const auto cholesky = MakeCholesky<6>(problem.pattern, dense_max);
    ASSERT_TRUE(cholesky->Factor(equations.H, 0.0));
    Eigen::MatrixXd x = equations.g;
    cholesky->SolveInPlace(x);
    EXPECT_LT((H * x - equations.g).norm(), 1e-9 * equations.g.norm()) << dense_max;
    const std::vector<Matrix6d> blocks = cholesky->InverseDiagonal();
    for (int v = 0; v < problem.free_count(); ++v) {
      const Matrix6d expected = inverse.block<6, 6>(6 * v, 6 * v);
      EXPECT_LT((blocks[static_cast<std::size_t>(v)] - expected).norm(), 1e-8 * expected.norm())
          << dense_max << " " << v;
    }
  }
}

TEST(GraphCholesky, AnIndefiniteMatrixIsRefusedByBothKinds) {
  const Problem problem = MakeProblem(MakeRig(50, 100, 26).graph);
  NormalEquations equations;
  Linearize(problem, SpanningTreePoses(problem), equations);
  equations.H.diagonal[30](2, 2) = -1.0;
  for (const int dense_max : {0, 1000})
    EXPECT_FALSE(MakeCholesky<6>(problem.pattern, dense_max)->Factor(equations.H, 0.0));
}

TEST(GraphSolve, FindsTheOptimumThatCeresFinds) {
  for (unsigned seed = 30; seed < 40; ++seed) {
    const RandomRig rig = MakeRig(4 + seed % 9, 20 + seed % 7, seed, 0.05, 0.05);
    const GraphSolution ours = Solve(rig.graph);
    GraphSolution start = ours;  // started away from our optimum
    std::mt19937 random(seed);
    for (std::size_t v = 1; v < start.poses.size(); ++v)
      start.poses[v].T_ref_sensor = rig.truth[v] * Se3::Exp(RandomVector(random, 0.01, 0.01));
    const CeresSolution theirs = SolveWithCeres(rig.graph, start);
    EXPECT_NEAR(ours.cost, theirs.cost, 1e-9 * theirs.cost) << seed;
    for (std::size_t v = 0; v < theirs.poses.size(); ++v) {
      const auto& x = theirs.poses[v];
      EXPECT_LT((ours.poses[v].T_ref_sensor.p_m - Eigen::Vector3d(x[0], x[1], x[2])).norm(), 1e-6) << seed << " " << v;
      const Eigen::Quaterniond q(x[6], x[3], x[4], x[5]);
      EXPECT_LT(ours.poses[v].T_ref_sensor.q.angularDistance(q), 1e-6) << seed << " " << v;
    }
  }
}

}  // namespace
}  // namespace rigcal::graph
