#include <ceres/cost_function.h>
#include <ceres/manifold.h>
#include <gmock/gmock.h>

#include <Eigen/Eigenvalues>

#include "server/calib/camera/projection.h"
#include "server/calib/core/costs.h"
#include "server/calib/core/pose_block.h"

namespace rigcal::calib {
namespace {

CameraIntrinsics LensOf(CameraModel model) {
  if (model == CameraModel::kPinholeRadtan) return {610, 590, 322, 238, {-0.28, 0.09, 0.004, -0.007, 0.02}, model};
  if (model == CameraModel::kPinholeRational)
    return {610, 590, 322, 238, {0.4, -0.06, 0.004, -0.007, 0.01, 0.7, 0.05, -0.02}, model};
  if (model == CameraModel::kEucm) return {310, 300, 322, 238, {0.62, 1.13}, model};
  if (model == CameraModel::kDoubleSphere) return {250, 240, 322, 238, {-0.21, 0.59}, model};
  return {310, 300, 322, 238, {-0.02, 0.03, -0.02, 0.004}, model};
}

Se3 Pose(const Eigen::Vector3d& p_m, const Eigen::Vector3d& axis, double angle_rad) {
  Se3 T;
  T.p_m = p_m;
  T.q = Eigen::AngleAxisd(angle_rad, axis.normalized());
  return T;
}

// exp of the 4x4 generator by its series: shares nothing with the closed forms.
Eigen::Matrix4d SeriesExp(const Vector6d& xi) {
  Eigen::Matrix4d generator = Eigen::Matrix4d::Zero();
  generator.topLeftCorner<3, 3>() << 0, -xi[5], xi[4], xi[5], 0, -xi[3], -xi[4], xi[3], 0;
  generator.topRightCorner<3, 1>() = xi.head<3>();
  Eigen::Matrix4d sum = Eigen::Matrix4d::Identity(), term = sum;
  for (int n = 1; n < 30; ++n) {
    term = term * generator / n;
    sum += term;
  }
  return sum;
}

TEST(Se3Manifold, PlusIsTheFullExponentialOnTheRight) {
  const auto manifold = MakeSe3Manifold();
  const Se3 T = Pose({0.3, -0.2, 1.1}, {1, 2, -1}, 0.8);
  const Vector6d xi = (Vector6d() << 0.4, -0.3, 0.2, 0.5, 0.7, -0.9).finished();
  const PoseBlock start = BlockOf(T);
  PoseBlock moved;
  ASSERT_TRUE(manifold->Plus(start.data(), xi.data(), moved.data()));
  EXPECT_LT((PoseOf(moved.data()).Matrix() - T.Matrix() * SeriesExp(xi)).norm(), 1e-12);
  Vector6d back;
  ASSERT_TRUE(manifold->Minus(moved.data(), start.data(), back.data()));
  EXPECT_LT((back - xi).norm(), 1e-12);
}

TEST(Se3Manifold, TranslationComesFirst) {
  const auto manifold = MakeSe3Manifold();
  const PoseBlock start = BlockOf(Pose({1, 2, 3}, {0, 0, 1}, M_PI / 2));
  const Vector6d forward = 0.5 * Vector6d::Unit(tangent::kX);
  PoseBlock moved;
  manifold->Plus(start.data(), forward.data(), moved.data());
  // x of a frame turned by 90 degrees about z points along y.
  EXPECT_LT((moved.head<3>() - Eigen::Vector3d(1, 2.5, 3)).norm(), 1e-12);
  EXPECT_LT((moved.tail<4>() - start.tail<4>()).norm(), 1e-12);
}

TEST(Se3Manifold, JacobiansAreThoseOfDifferences) {
  const auto manifold = MakeSe3Manifold();
  const Se3 T = Pose({0.3, -0.2, 1.1}, {1, 2, -1}, 0.8);
  const PoseBlock start = BlockOf(T);
  Eigen::Matrix<double, kPoseSize, 6, Eigen::RowMajor> plus;
  Eigen::Matrix<double, 6, kPoseSize, Eigen::RowMajor> minus;
  manifold->PlusJacobian(start.data(), plus.data());
  manifold->MinusJacobian(start.data(), minus.data());
  for (int i = 0; i < 6; ++i) {
    PoseBlock ahead, behind;
    const Vector6d step = 1e-6 * Vector6d::Unit(i), back = -step;
    manifold->Plus(start.data(), step.data(), ahead.data());
    manifold->Plus(start.data(), back.data(), behind.data());
    EXPECT_LT(((ahead - behind) / 2e-6 - plus.col(i)).norm(), 1e-8) << i;
  }
  EXPECT_LT((minus * plus - Matrix6d::Identity()).norm(), 1e-12);
}

// Far from zero residual, so that a Jacobian that is right only at the solution fails.
class CostDerivatives : public testing::TestWithParam<CameraModel> {
 protected:
  static Eigen::VectorXd Residuals(const ceres::CostFunction& cost, const std::vector<const double*>& blocks) {
    Eigen::VectorXd residuals(cost.num_residuals());
    EXPECT_TRUE(cost.Evaluate(blocks.data(), residuals.data(), nullptr));
    return residuals;
  }
  void ExpectRightJacobian(const ceres::CostFunction& cost, std::vector<const double*> blocks, std::size_t which) {
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const int size = cost.parameter_block_sizes()[which];
    RowMajor analytic(cost.num_residuals(), size);
    std::vector<double*> jacobians(blocks.size(), nullptr);
    jacobians[which] = analytic.data();
    Eigen::VectorXd residuals(cost.num_residuals());
    ASSERT_TRUE(cost.Evaluate(blocks.data(), residuals.data(), jacobians.data()));
    ASSERT_GT(residuals.norm(), 10);
    const Eigen::VectorXd point = Eigen::Map<const Eigen::VectorXd>(blocks[which], size);
    for (int i = 0; i < (size == kPoseSize ? 6 : size); ++i) {
      Eigen::VectorXd ahead = point, behind = point, direction = Eigen::VectorXd::Unit(size, i);
      if (size == kPoseSize) {  // along the manifold only: off it the rotation is not one
        const Se3 T = PoseOf(point.data());
        ahead = BlockOf(T * Se3::Exp(1e-6 * Vector6d::Unit(i)));
        behind = BlockOf(T * Se3::Exp(-1e-6 * Vector6d::Unit(i)));
        direction = PlusJacobian(T).col(i);
      } else {
        ahead[i] += 1e-6;
        behind[i] -= 1e-6;
      }
      blocks[which] = ahead.data();
      const Eigen::VectorXd at_ahead = Residuals(cost, blocks);
      blocks[which] = behind.data();
      const Eigen::VectorXd slope = (at_ahead - Residuals(cost, blocks)) / 2e-6;
      EXPECT_LT((slope - analytic * direction).norm(), 1e-5 * (1 + slope.norm())) << "block " << which << " axis " << i;
    }
  }

  CameraModel model_ = GetParam();
  std::vector<Eigen::Vector3d> corners_board_ = {{0, 0, 0}, {0.03, 0, 0}, {0, 0.03, 0}, {9, 9, 9}, {0.2, 0.1, 0}};
  SeenCorners seen_{{1, 0, 2, 4}, {{310, 260}, {300, 200}, {250, 240}, {400, 300}}};
  IntrinsicsVector lens_ = VectorOf(LensOf(GetParam()));
  PoseBlock T_a_board_ = BlockOf(Pose({-0.05, 0.02, 0.6}, {1, -0.4, 0.3}, 0.5));
  PoseBlock T_a_b_ = BlockOf(Pose({0.12, 0.01, -0.02}, {0.1, 1, 0.2}, 0.2));
};
INSTANTIATE_TEST_SUITE_P(All, CostDerivatives,
                         testing::Values(CameraModel::kPinholeRadtan, CameraModel::kPinholeRational,
                                         CameraModel::kFisheyeKb4, CameraModel::kEucm, CameraModel::kDoubleSphere),
                         [](const auto& tested) { return NameOf(tested.param); });

TEST_P(CostDerivatives, ReferenceView) {
  const auto cost = MakeReferenceViewCost(model_, corners_board_, seen_);
  EXPECT_EQ(cost->parameter_block_sizes()[0], IntrinsicsCount(model_));
  for (std::size_t which = 0; which < 2; ++which) ExpectRightJacobian(*cost, {lens_.data(), T_a_board_.data()}, which);
}

TEST_P(CostDerivatives, SecondView) {
  const auto cost = MakeSecondViewCost(model_, corners_board_, seen_);
  for (std::size_t which = 0; which < 3; ++which)
    ExpectRightJacobian(*cost, {lens_.data(), T_a_b_.data(), T_a_board_.data()}, which);
}

TEST_P(CostDerivatives, SecondViewIsTheChainThroughA) {
  const auto chained = MakeSecondViewCost(model_, corners_board_, seen_);
  const auto direct = MakeReferenceViewCost(model_, corners_board_, seen_);
  const Eigen::Matrix4d T_b_board = PoseOf(T_a_b_.data()).Matrix().inverse() * PoseOf(T_a_board_.data()).Matrix();
  const PoseBlock block = BlockOf(Se3::FromMatrix(T_b_board));
  EXPECT_LT((Residuals(*chained, {lens_.data(), T_a_b_.data(), T_a_board_.data()}) -
             Residuals(*direct, {lens_.data(), block.data()}))
                .norm(),
            1e-9);
}

}  // namespace
}  // namespace rigcal::calib
