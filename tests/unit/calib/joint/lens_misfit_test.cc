// The parts of what finds a lens that bends beyond its model: field, observation by its coefficients, variance
// components.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

#include "client/sim/rig/rig_yaml.h"
#include "server/calib/joint/problem/observation.h"
#include "server/calib/joint/refine/variance_components.h"
#include "tests/bench/rig/joint_session.h"

namespace rigcal::calib::joint {
namespace {

TEST(SplineField, FollowsAPlaneExactly) {
  const FieldGrid grid = FieldGridOf({2448, 2048});
  Eigen::VectorXd coefficients_px(2 * grid.points());
  for (int j = 0; j < grid.rows; ++j)
    for (int i = 0; i < grid.columns; ++i) {
      const Eigen::Vector2d centre_px = grid.cell_px * Eigen::Vector2d(i - 0.5, j - 0.5) - Eigen::Vector2d(0.5, 0.5);
      coefficients_px[j * grid.columns + i] = 0.3 + 1e-3 * centre_px.x();
      coefficients_px[grid.points() + j * grid.columns + i] = 2e-3 * centre_px.y() - 1e-3 * centre_px.x();
    }
  for (const Eigen::Vector2d& uv_px : {Eigen::Vector2d(0, 0), {2447, 2047}, {244.7, 10}, {1000.3, 1777.7}}) {
    const Eigen::Vector2d expected(0.3 + 1e-3 * uv_px.x(), 2e-3 * uv_px.y() - 1e-3 * uv_px.x());
    EXPECT_LT((FieldAt(grid, coefficients_px, uv_px) - expected).norm(), 1e-12) << uv_px.transpose();
  }
}

TEST(SplineField, BesideThePictureIsAsItsEdgeAndWithoutAPictureThereIsNone) {
  const FieldGrid grid = FieldGridOf({640, 480});
  Eigen::VectorXd coefficients_px = Eigen::VectorXd::LinSpaced(2 * grid.points(), -1, 1);
  EXPECT_EQ(FieldAt(grid, coefficients_px, {-50, 100}), FieldAt(grid, coefficients_px, {-0.5, 100}));
  EXPECT_EQ(FieldAt(grid, coefficients_px, {700, 500}), FieldAt(grid, coefficients_px, {639.5, 479.5}));
  EXPECT_EQ(FieldGridOf({}).points(), 0);
}

TEST(LensMisfit, ScoreOfALookIsTheGradientOfItsCost) {
  sim::Options options;
  options.seed = 3;
  options.captures = 6;
  const FeatureSession session = RecordFeatures(*sim::Prepare(*sim::LoadRig("mars-mapper"), options), 0);
  auto start = StartOf(ViewsOf(session, NominalPoses(session))).value();
  const CornersSeen& seen = start.problem.corners[4];
  const auto camera = static_cast<std::size_t>(seen.camera);
  const FieldGrid grid = FieldGridOf(start.problem.cameras[camera].picture);
  ASSERT_GT(grid.points(), 0);
  std::vector<int> all(static_cast<std::size_t>(grid.points()));
  for (int i = 0; i < grid.points(); ++i) all[static_cast<std::size_t>(i)] = i;
  start.state.field_px.assign(start.problem.cameras.size(), {});
  start.state.field_px[camera] = Eigen::VectorXd::LinSpaced(2 * grid.points(), -1, 1);
  const SensorNoise noise{50.0, 0.0};
  const Layout layout = LayoutOf(start.problem);
  const auto look = ObserveWithField(start.problem, layout, start.state, seen, noise, 1.0, all);
  ASSERT_TRUE(look);
  ASSERT_GT(look->b.cwiseAbs().maxCoeff(), 0.0);
  for (int k = 0; k < 2 * grid.points(); ++k) {
    const auto cost = [&](double by_px) {
      SessionState state = start.state;
      state.field_px[camera][k] += by_px;
      return Observe(start.problem, layout, state, seen, noise, 1.0)->cost;
    };
    EXPECT_NEAR((cost(0.1) - cost(-0.1)) / 0.2, 2 * look->b[k], 1e-7) << k;
  }
}

// Three blocks of effects that are seen through one another; the second has none.
struct Drawn {
  RandomEffects effects;
  Eigen::VectorXd truth;
  Eigen::MatrixXd D;
};
Drawn Draw(unsigned seed) {
  constexpr int kSize = 30;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto matrix = [&](int rows, int columns) {
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); }).eval();
  };
  const Eigen::MatrixXd J = matrix(400, 3 * kSize);
  Drawn drawn;
  drawn.effects.at = {0, kSize, 2 * kSize, 3 * kSize};
  drawn.effects.S = J.transpose() * J;
  Eigen::VectorXd sigma(3 * kSize);
  sigma << Eigen::VectorXd::Constant(kSize, 0.5), Eigen::VectorXd::Zero(kSize), Eigen::VectorXd::Constant(kSize, 2.0);
  drawn.D = sigma.cwiseAbs2().asDiagonal();
  drawn.truth = sigma.cwiseProduct(matrix(3 * kSize, 1));
  drawn.effects.score = -J.transpose() * (J * drawn.truth + matrix(400, 1));
  return drawn;
}

TEST(VarianceComponents, AreFoundBesideOneAnother) {
  for (const unsigned seed : {1u, 2u, 3u, 4u}) {
    const Drawn drawn = Draw(seed);
    const Components found = EstimateComponents(drawn.effects);
    EXPECT_NEAR(std::sqrt(found.variance[0]), 0.5, 0.25);  // 30 numbers tell a sigma to 13 %
    EXPECT_NEAR(std::sqrt(found.variance[2]), 2.0, 1.0);
    EXPECT_LT(std::sqrt(found.variance[1]), 0.05);
    EXPECT_GT(found.evidence[0], 100.0);
    EXPECT_LT(found.evidence[1], 10.0);
    EXPECT_LT((found.mean - drawn.truth).norm(), 0.1 * drawn.truth.norm());
  }
}

TEST(VarianceComponents, PosteriorIsThatOfTheWholeProblem) {
  const Drawn drawn = Draw(5);
  const Components found = EstimateComponents(drawn.effects);
  Eigen::MatrixXd by = Eigen::MatrixXd::Random(4, drawn.effects.score.size());
  Eigen::VectorXd roots(drawn.effects.score.size());
  for (std::size_t k = 0; k < 3; ++k)
    roots.segment(drawn.effects.at[k], drawn.effects.size(k)).setConstant(std::sqrt(found.variance[k]));
  Eigen::MatrixXd B = roots.asDiagonal() * drawn.effects.S * roots.asDiagonal();
  B.diagonal().array() += 1.0;
  const Eigen::MatrixXd half = by * roots.asDiagonal();
  const Eigen::MatrixXd expected = half * B.ldlt().solve(half.transpose());
  EXPECT_LT((PosteriorThrough(found, by) - expected).norm(), 1e-6 * expected.norm());
  EXPECT_GT(PriorThrough(found, by).trace(), expected.trace());
  EXPECT_NEAR(PosteriorThrough(found, 2, by.rightCols(30)).trace(),
              (half.rightCols(30) * B.inverse().bottomRightCorner(30, 30) * half.rightCols(30).transpose()).trace(),
              1e-9);
}

}  // namespace
}  // namespace rigcal::calib::joint
