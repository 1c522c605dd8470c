// Kernels for wide registers against those that every x86-64 runs, bit for bit, and against formulas that share nothing
// with them.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <array>
#include <cstring>
#include <limits>
#include <random>

#include "server/graph/large/block_matrix.h"
#include "server/graph/large/lane_kernels.h"
#include "server/graph/solve/linearize.h"
#include "server/math/se3.h"
#include "tests/unit/graph/fixture.h"

namespace rigcal::graph {
namespace {

Matrix6d RandomInformation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Matrix6d root;
  for (double& entry : root.reshaped()) entry = normal(random);
  const Matrix6d Omega = root * root.transpose() + Matrix6d::Identity();
  return 0.5 * (Omega + Omega.transpose());
}

Se3 RandomPose(std::mt19937& random) { return Se3::Exp(RandomVector(random, 1.0, 1.0)).Normalized(); }

// A positive definite matrix of 30 rows, as a Triangle.
struct Stored {
  static constexpr Eigen::Index kRows = 30;
  Eigen::MatrixXd full, entries = Eigen::MatrixXd::Zero(kRows + kLanes, kRows);

  explicit Stored(unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    Eigen::MatrixXd root(kRows, kRows);
    for (double& entry : root.reshaped()) entry = normal(random);
    full = root * root.transpose() + Eigen::MatrixXd::Identity(kRows, kRows);
    entries.topRows(kRows).triangularView<Eigen::Lower>() = full;
  }
  [[nodiscard]] Triangle View() { return {entries.data(), kRows, kRows + kLanes}; }
};

bool SameBits(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0;
}

// A factor, a solution and columns of the inverse.
struct Solved {
  Eigen::MatrixXd factor, x, inverse;
};
Solved SolveWith(const LaneKernels& kernels, unsigned seed) {
  Stored matrix(seed);
  EXPECT_TRUE(kernels.Factor(matrix.View(), 0));
  Eigen::VectorXd x = Eigen::VectorXd::Zero(Stored::kRows + kLanes);
  x.head(Stored::kRows).setLinSpaced(-1.0, 2.0);
  kernels.Solve(matrix.View(), x.data());
  Eigen::MatrixXd inverse(2 * kLanes, Stored::kRows - 6);
  kernels.InverseColumns(matrix.View(), 6, inverse.data());
  return {matrix.entries, x, inverse};
}

TEST(GraphLanes, TriangleIsSolvedToTheSameBitsAndRightly) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Solved wide = SolveWith(Kernels(), seed), portable = SolveWith(PortableKernels(), seed);
    EXPECT_TRUE(SameBits(wide.factor, portable.factor));
    EXPECT_TRUE(SameBits(wide.x, portable.x));
    EXPECT_TRUE(SameBits(wide.inverse, portable.inverse));
    const Eigen::MatrixXd full = Stored(seed).full;
    const Eigen::VectorXd rhs = Eigen::VectorXd::LinSpaced(Stored::kRows, -1.0, 2.0);
    EXPECT_LT((full * wide.x.topRows(Stored::kRows) - rhs).norm(), 1e-9);
    const Eigen::MatrixXd L = full.llt().matrixL();
    const Eigen::MatrixXd L_inverse = L.inverse().block(6, 6, Stored::kRows - 6, 2 * kLanes);
    EXPECT_LT((wide.inverse.transpose() - L_inverse).norm(), 1e-10 * L_inverse.norm());
  }
}

TEST(GraphLanes, AFactorIsRenewedFromAPanelOn) {
  Stored matrix(31), changed(31);
  ASSERT_TRUE(Kernels().Factor(matrix.View(), 0));
  changed.entries(20, 20) += 1.0;  // in panel 3
  Eigen::MatrixXd renewed = matrix.entries;
  renewed.rightCols(Stored::kRows - 18) = changed.entries.rightCols(Stored::kRows - 18);
  ASSERT_TRUE(Kernels().Factor({renewed.data(), Stored::kRows, Stored::kRows + kLanes}, 3));
  ASSERT_TRUE(Kernels().Factor(changed.View(), 0));
  const auto lower = [](const Eigen::MatrixXd& m) -> Eigen::MatrixXd {
    return m.topRows(Stored::kRows).triangularView<Eigen::Lower>();
  };
  EXPECT_TRUE(SameBits(lower(renewed), lower(changed.entries)));
}

TEST(GraphLanes, AnIndefiniteTriangleIsRefused) {
  for (const double bad :
       {-1.0, 0.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Stored matrix(32);
    matrix.entries(13, 13) = bad;
    EXPECT_FALSE(Kernels().Factor(matrix.View(), 0)) << bad;
    EXPECT_FALSE(PortableKernels().Factor(matrix.View(), 0)) << bad;
  }
}

// Blocks of B rows do not fill the last panel.
template <int B>
void ExpectSolvedDense(int count) {
  BlockPattern pattern{count, {}};
  for (int c = 0; c + 1 < count; ++c) pattern.off_diagonal.push_back({c + 1, c});
  BlockMatrix<B> matrix;
  matrix.SetZero(pattern);
  Eigen::MatrixXd full = Eigen::MatrixXd::Zero(B * count, B * count);
  for (int c = 0; c < count; ++c) {
    const auto k = static_cast<std::size_t>(c);
    matrix.diagonal[k] =
        Eigen::Matrix<double, B, B>::Constant(0.5) + (3.0 + c) * Eigen::Matrix<double, B, B>::Identity();
    full.block<B, B>(B * c, B * c) = matrix.diagonal[k];
    if (c + 1 == count) break;
    matrix.off_diagonal[k].setConstant(0.3);
    full.block<B, B>(B * (c + 1), B * c).setConstant(0.3);
    full.block<B, B>(B * c, B * (c + 1)).setConstant(0.3);
  }
  const auto cholesky = MakeCholesky<B>(pattern);
  BlockMatrix<B> spoilt = matrix;
  (count > 1 ? spoilt.off_diagonal : spoilt.diagonal)[0].setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(cholesky->Factor(spoilt, 0.0));  // and leaves nothing behind
  ASSERT_TRUE(cholesky->Factor(matrix, 0.0));
  Eigen::MatrixXd infinite = Eigen::MatrixXd::Ones(B * count, 2);
  infinite(0, 0) = std::numeric_limits<double>::infinity();
  cholesky->SolveInPlace(infinite);
  EXPECT_TRUE(infinite.col(1).allFinite());
  Eigen::MatrixXd x = Eigen::MatrixXd::Ones(B * count, 2);
  cholesky->SolveInPlace(x);
  EXPECT_LT((full * x - Eigen::MatrixXd::Ones(B * count, 2)).norm(), 1e-12);
  const Eigen::MatrixXd inverse = full.inverse();
  const auto blocks = cholesky->InverseDiagonal();
  for (int c = 0; c < count; ++c)
    EXPECT_LT((blocks[static_cast<std::size_t>(c)] - inverse.block<B, B>(B * c, B * c)).norm(), 1e-12) << B << " " << c;
}

TEST(GraphLanes, SmallBlocksAreSolvedDense) {
  for (const int count : {1, 2, 5, 7}) {
    ExpectSolvedDense<1>(count);
    ExpectSolvedDense<3>(count);
    ExpectSolvedDense<6>(count);
  }
}

// Four edges with small residuals at random poses.
struct FourEdges {
  std::array<Matrix6d, kLanes> Omega;
  std::array<Se3, kLanes> T_i, T_j, T_j_i;

  explicit FourEdges(unsigned seed, double residual_rad = 0.05) {
    std::mt19937 random(seed);
    for (std::size_t k = 0; k < kLanes; ++k) {
      Omega[k] = RandomInformation(random);
      T_i[k] = RandomPose(random);
      T_j[k] = RandomPose(random);
      const Vector6d e = RandomVector(random, 0.2, residual_rad);
      T_j_i[k] = (Se3::Exp(e) * T_j[k].Inverse() * T_i[k]).Normalized();
    }
  }
  [[nodiscard]] EdgeLanes Lanes() const {
    EdgeLanes lanes;
    for (std::size_t k = 0; k < kLanes; ++k) {
      lanes.Omega[k] = Omega[k].data();
      lanes.p_j_i_m[k] = T_j_i[k].p_m.data();
      lanes.q_j_i[k] = T_j_i[k].q.coeffs().data();
      lanes.p_i_m[k] = T_i[k].p_m.data();
      lanes.q_i[k] = T_i[k].q.coeffs().data();
      lanes.p_j_m[k] = T_j[k].p_m.data();
      lanes.q_j[k] = T_j[k].q.coeffs().data();
    }
    return lanes;
  }
  // e = Log(T_j_i T_i^-1 T_j).
  [[nodiscard]] Vector6d Residual(std::size_t k) const { return (T_j_i[k] * T_i[k].Inverse() * T_j[k]).Log(); }
};

Vector6d Lane(const EdgeTwists& twists, std::size_t lane) {
  Vector6d twist;
  for (int k = 0; k < 6; ++k) twist(k) = twists.numbers[k][lane];
  return twist;
}

TEST(GraphLanes, ForcesAreThoseOfTheClosedForms) {
  for (unsigned seed = 40; seed < 60; ++seed) {
    const FourEdges edges(seed);
    EdgeForces wide, portable;
    ASSERT_TRUE(Kernels().Forces(edges.Lanes(), wide));
    ASSERT_TRUE(PortableKernels().Forces(edges.Lanes(), portable));
    EXPECT_EQ(std::memcmp(&wide, &portable, sizeof wide), 0);
    for (std::size_t k = 0; k < kLanes; ++k) {
      const Vector6d e = edges.Residual(k), weighted = edges.Omega[k] * e;
      const Matrix6d J_j = RightJacobianInverse(e), J_i = -J_j * Adjoint(edges.T_j[k].Inverse() * edges.T_i[k]);
      const Vector6d on_i = -J_i.transpose() * weighted, on_j = J_j.transpose() * weighted;
      EXPECT_LT((Lane(wide.on_i, k) - on_i).norm(), 1e-11 * on_i.norm());
      EXPECT_LT((Lane(wide.on_j, k) - on_j).norm(), 1e-11 * on_j.norm());
      EXPECT_NEAR(wide.cost[k], e.dot(weighted), 1e-11 * wide.cost[k]);
    }
  }
}

TEST(GraphLanes, OneLargeRotationLeavesAllFourToTheClosedForms) {
  EdgeForces forces;
  EdgeTwists e;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    FourEdges edges(61);
    edges.T_j_i[lane].q = edges.T_j_i[lane].q * Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitY());
    for (const LaneKernels* kernels : {&Kernels(), &PortableKernels()}) {
      EXPECT_FALSE(kernels->Forces(edges.Lanes(), forces)) << lane;
      EXPECT_FALSE(kernels->Residuals(edges.Lanes(), e)) << lane;
    }
  }
}

// One to nine edges of a graph, one of them with a large rotation: groups that are not full, and mixed.
TEST(GraphLanes, GraphsOfAnySizeHaveTheGradientOfTheClosedForms) {
  for (unsigned count = 1; count <= 9; ++count) {
    RandomRig rig = MakeRig(4, 9, 70 + count, 0.05, 0.02);
    rig.graph.edges.resize(count);
    rig.graph.edges.back().T_a_b = rig.graph.edges.back().T_a_b * Se3::Exp(Vector6d::Constant(count % 2 ? 0.0 : 0.7));
    const Problem problem = MakeProblem(rig.graph);
    const Poses T_ref(static_cast<std::size_t>(problem.vertex_count));
    Eigen::VectorXd g = Eigen::VectorXd::Zero(6 * problem.free_count());
    double cost = 0.0;
    const std::vector<Vector6d> residuals = Residuals(problem, T_ref);
    for (std::size_t k = 0; k < problem.constraints.size(); ++k) {
      const Constraint& c = problem.constraints[k];
      const EdgeJacobian jacobian = JacobianOf(c, T_ref);
      EXPECT_LT((residuals[k] - jacobian.e).norm(), 1e-12) << count << " " << k;
      Eigen::MatrixXd column = g;
      AddToGradient(c, jacobian, jacobian.e, column);
      g = column;
      cost += jacobian.e.dot(c.Omega * jacobian.e);
    }
    NormalEquations exact, gradient;
    Linearize(problem, T_ref, exact);
    LinearizeGradient(problem, T_ref, gradient);
    EXPECT_LT((exact.g - g).norm(), 1e-10 * g.norm() + 1e-300) << count;
    EXPECT_LT((gradient.g - g).norm(), 1e-10 * g.norm() + 1e-300) << count;
    EXPECT_NEAR(gradient.cost, cost, 1e-10 * cost) << count;
  }
}

TEST(GraphLanes, BlocksAreProductsWithTheAdjoint) {
  const FourEdges edges(62);
  BlockLanes lanes;
  std::array<Matrix6d, kLanes> WA, AWA, WA_portable, AWA_portable;
  std::array<double*, kLanes> at{}, at_A{}, portable{}, portable_A{};
  for (std::size_t k = 0; k < kLanes; ++k) {
    lanes.W[k] = edges.Omega[k].data();
    lanes.p_i_j_m[k] = edges.T_i[k].p_m.data();
    lanes.q_i_j[k] = edges.T_i[k].q.coeffs().data();
    at[k] = WA[k].data(), at_A[k] = AWA[k].data();
    portable[k] = WA_portable[k].data(), portable_A[k] = AWA_portable[k].data();
  }
  Kernels().Blocks(lanes, at.data(), at_A.data());
  PortableKernels().Blocks(lanes, portable.data(), portable_A.data());
  for (std::size_t k = 0; k < kLanes; ++k) {
    EXPECT_TRUE(SameBits(WA[k], WA_portable[k]) && SameBits(AWA[k], AWA_portable[k]));
    const Matrix6d A = Adjoint(edges.T_i[k].Inverse()), expected = A.transpose() * edges.Omega[k] * A;
    EXPECT_LT((WA[k] - edges.Omega[k] * A).norm(), 1e-12 * expected.norm());
    EXPECT_LT((AWA[k] - expected).norm(), 1e-12 * expected.norm());
  }
}

TEST(GraphLanes, InformationIsJudgedMatrixByMatrix) {
  std::mt19937 random(63);
  std::array<Matrix6d, kLanes> Omega;
  for (Matrix6d& matrix : Omega) matrix = RandomInformation(random);
  Omega[1](2, 4) += 0.25;
  Omega[2] = -Omega[2];
  Omega[3](5, 1) = std::numeric_limits<double>::quiet_NaN();
  const std::array<const double*, kLanes> at = {Omega[0].data(), Omega[1].data(), Omega[2].data(), Omega[3].data()};
  for (const LaneKernels* kernels : {&Kernels(), &PortableKernels()}) {
    InformationLanes lanes;
    kernels->Information(at.data(), lanes);
    EXPECT_EQ(lanes.asymmetry[0], 0.0);
    EXPECT_NEAR(lanes.asymmetry[1], 0.25, 1e-14);
    EXPECT_NE(lanes.is_clear[0], 0.0);
    EXPECT_EQ(lanes.is_clear[2], 0.0);
    EXPECT_EQ(lanes.is_clear[3], 0.0);
    EXPECT_NEAR(lanes.pivot_product[0], Omega[0].determinant(), 1e-10 * Omega[0].determinant());
    EXPECT_EQ(lanes.largest_of_diagonal[0], Omega[0].diagonal().maxCoeff());
  }
}

TEST(GraphLanes, APivotIsClearOnlyFarAboveRounding) {
  for (const auto& [ratio, is_clear] : {std::pair(1e-9, true), std::pair(1e-11, false)}) {
    Matrix6d Omega = Matrix6d::Identity();
    Omega(5, 4) = Omega(4, 5) = std::sqrt(1.0 - ratio);  // the last pivot is `ratio`
    const std::array<const double*, kLanes> at = {Omega.data(), Omega.data(), Omega.data(), Omega.data()};
    for (const LaneKernels* kernels : {&Kernels(), &PortableKernels()}) {
      InformationLanes lanes;
      kernels->Information(at.data(), lanes);
      for (const double clear : lanes.is_clear) EXPECT_EQ(clear != 0.0, is_clear) << ratio;
    }
  }
}

TEST(GraphLanes, AnEdgeOfRankFiveIsNotBelievedToHaveSix) {
  GraphEdge edge;
  edge.id = EdgeId("e");
  edge.frame_a = SensorId("a");
  edge.frame_b = SensorId("b");
  const Vector6d free = Vector6d::LinSpaced(1.0, 2.0).normalized();
  edge.Omega = 100.0 * (Matrix6d::Identity() - free * free.transpose());
  edge.rank = 6;
  Constraint constraint;
  EXPECT_EQ(FillConstraint(edge, 0, constraint), "");
  EXPECT_EQ(constraint.rank, 5);
}

}  // namespace
}  // namespace rigcal::graph
