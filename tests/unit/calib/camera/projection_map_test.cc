// How uncertain projections are: against draws from the covariance, each with its own best motion of the boards. What
// changed in a lens: against closed forms, and a search for the best turn that shares no code with the one under test.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <functional>
#include <random>

#include "server/calib/camera/camera_fit.h"
#include "server/calib/camera/projection_maps.h"
#include "server/model/sensors/coverage.h"
#include "tests/unit/calib/virtual_pair.h"

namespace rigcal::calib {
namespace {

// Pinhole with radial and tangential distortion, as OpenCV's documentation has it.
Eigen::Vector2d Pixel(const Eigen::VectorXd& b, const Eigen::Vector3d& p) {
  const double x = p.x() / p.z(), y = p.y() / p.z(), s = x * x + y * y;
  const double radial = 1 + b[4] * s + b[5] * s * s + b[8] * s * s * s;
  return {b[0] * (x * radial + 2 * b[6] * x * y + b[7] * (s + 2 * x * x)) + b[2],
          b[1] * (y * radial + b[6] * (s + 2 * y * y) + 2 * b[7] * x * y) + b[3]};
}

Eigen::VectorXd Numbers(const CameraIntrinsics& lens) {
  Eigen::VectorXd b(9);
  b << lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px, Eigen::Map<const Eigen::VectorXd>(lens.distortion.data(), 5);
  return b;
}

// The argument with the least sum of squares, from zero: Gauss and Newton by differences.
Eigen::VectorXd LeastSquares(int size, const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& residuals) {
  constexpr double kStep = 1e-6;
  Eigen::VectorXd at = Eigen::VectorXd::Zero(size);
  for (int round = 0; round < 4; ++round) {
    const Eigen::VectorXd r = residuals(at);
    Eigen::MatrixXd J(r.size(), size);
    for (int i = 0; i < size; ++i) J.col(i) = (residuals(at + kStep * Eigen::VectorXd::Unit(size, i)) - r) / kStep;
    at -= (J.transpose() * J).ldlt().solve(J.transpose() * r);
  }
  return at;
}

struct SolvedCamera {
  CameraFit fit;
  std::vector<Eigen::Vector3d> corners_m;  // of all boards, in the camera
};

SolvedCamera Solved(const VirtualPair& pair, int boards, double sigma_px) {
  const StereoProblem photographed = Photographed(pair, TiltedBoards(boards), sigma_px, 7);
  CameraProblem problem{photographed.camera_a, pair.board, {}};
  for (const StereoCapture& capture : photographed.captures) problem.views.emplace_back(capture.capture, *capture.a);
  const auto estimate = EstimateCamera(problem);
  EXPECT_TRUE(estimate);
  SolvedCamera solved{FitOf(problem, estimate->intrinsics, estimate->T_cam_board), {}};
  for (const auto& [capture, T_cam_board] : estimate->T_cam_board)
    for (const Eigen::Vector3d& point : TargetPoints(pair.board)) solved.corners_m.push_back(T_cam_board * point);
  return solved;
}

// The one motion of all corners that keeps their pixels when the intrinsics become `moved`.
Se3 MotionFor(const SolvedCamera& solved, const Eigen::VectorXd& b, const Eigen::VectorXd& moved) {
  const auto count = static_cast<Eigen::Index>(solved.corners_m.size());
  return Se3::Exp(LeastSquares(6, [&](const Eigen::VectorXd& xi) {
    const Se3 motion = Se3::Exp(xi);
    Eigen::VectorXd r(2 * count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Vector3d& corner_m = solved.corners_m[static_cast<std::size_t>(i)];
      r.segment<2>(2 * i) = Pixel(moved, motion * corner_m) - Pixel(b, corner_m);
    }
    return r;
  }));
}

double WorstDirectionOf(const Eigen::Matrix2d& squares, int draws) {
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(squares / draws).eigenvalues()[1]);
}

TEST(UncertaintyOfProjections, IsWhatDrawsFromTheCovarianceDo) {
  constexpr int kDraws = 2000;
  const SolvedCamera solved = Solved(VirtualPair(), 9, 0.2);
  const auto map = UncertaintyOfProjections(solved.fit);
  ASSERT_TRUE(map);
  const Eigen::VectorXd b = Numbers(solved.fit.intrinsics);
  const Eigen::VectorXd scale = solved.fit.covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> correlation(scale.asDiagonal() * solved.fit.covariance *
                                                                   scale.asDiagonal());
  const Eigen::MatrixXd root = scale.cwiseInverse().asDiagonal() * correlation.eigenvectors() *
                               correlation.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  const std::vector<std::pair<int, int>> places = {{0, 0}, {11, 8}, {6, 4}, {11, 3}, {3, 6}};
  std::vector<Eigen::Vector3d> rays;
  for (const auto& [column, row] : places) {
    const Eigen::Vector2d uv_px(MiddleOf(column, 640, 12), MiddleOf(row, 480, 9));
    rays.push_back(*Unproject(CameraModel::kPinholeRadtan, VectorOf(solved.fit.intrinsics), uv_px));
  }
  std::vector<Eigen::Matrix2d> far(places.size(), Eigen::Matrix2d::Zero()), near = far;
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  for (int draw = 0; draw < kDraws; ++draw) {
    const Eigen::VectorXd moved = b + root * Eigen::VectorXd::NullaryExpr(9, [&] { return normal(random); });
    const Se3 motion = MotionFor(solved, b, moved);
    const auto add = [&](double distance_m, std::size_t i, std::vector<Eigen::Matrix2d>& squares) {
      const Eigen::Vector3d p = distance_m * rays[i];
      const Eigen::Vector2d d_px = Pixel(moved, motion * p) - Pixel(b, p);
      squares[i] += d_px * d_px.transpose();
    };
    for (std::size_t i = 0; i < places.size(); ++i) add(1e6, i, far), add(kNearPoint_m, i, near);
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    const PointSigma& told = map->fields[static_cast<std::size_t>(places[i].second * map->columns + places[i].first)];
    const double far_px = WorstDirectionOf(far[i], kDraws), near_px = WorstDirectionOf(near[i], kDraws);
    // A sigma of so many draws is known to 1 / sqrt(2 draws); six times that.
    EXPECT_NEAR(*told.far_px, far_px, 0.095 * far_px) << i;
    EXPECT_NEAR(*told.near_px, near_px, 0.095 * near_px) << i;
  }
  EXPECT_GT(*map->middle.far_px, 1.1 * *map->middle.near_px) << "the distance matters";
}

// Where the middle of the picture is, is known to 1 px alone: of a narrow lens that is a turn of the camera.
TEST(UncertaintyOfProjections, WhatATurnExplainsDoesNotCount) {
  VirtualPair pair;
  pair.a = {3000, 3000, 319.5, 239.5, {0, 0, 0, 0, 0}};
  const Se3 T_cam_board = BoardAt(pair, {0.0, 0.0, 3.0}, {0.4, 0.3, 0.0});
  const StereoProblem photographed = Photographed(pair, {T_cam_board}, 0.0, 1);
  CameraProblem problem{photographed.camera_a, pair.board, {}};
  problem.views.emplace_back(photographed.captures[0].capture, *photographed.captures[0].a);
  problem.camera.intrinsics = pair.a;
  problem.camera.intrinsics_sigma = std::vector<double>{0, 0, 1, 0, 0, 0, 0, 0, 0};
  CameraFit fit = FitOf(problem, pair.a, {{problem.views[0].first, T_cam_board}});
  ASSERT_EQ(fit.covariance.rows(), 9);
  fit.covariance(2, 2) = 1.0;
  const auto map = UncertaintyOfProjections(fit);
  ASSERT_TRUE(map);
  for (const PointSigma& field : map->fields) EXPECT_LT(*field.far_px, 0.1);
  fit.implied_motion.setZero();
  EXPECT_NEAR(*UncertaintyOfProjections(fit)->middle.far_px, 1.0, 1e-9) << "without the turn it is all there";
}

TEST(UncertaintyOfProjections, IsNotToldWhereNothingIsKnown) {
  CameraFit fit = Solved(VirtualPair(), 6, 0.2).fit;
  ASSERT_TRUE(UncertaintyOfProjections(fit));
  CameraFit without = fit;
  without.covariance = Eigen::MatrixXd();
  EXPECT_FALSE(UncertaintyOfProjections(without));
  fit.width_px = 0;
  EXPECT_FALSE(UncertaintyOfProjections(fit));
}

// A camera of 1200 x 900 that saw a corner in every field of its columns from `first` on.
CameraFit Camera(const CameraIntrinsics& lens, int first = 0) {
  CameraFit fit;
  fit.camera = SensorId("front");
  fit.width_px = 1200, fit.height_px = 900;
  fit.source = IntrinsicsSource::kEstimated;
  fit.intrinsics = lens;
  fit.views.resize(1);
  for (int row = 0; row < 9; ++row)
    for (int column = first; column < 12; ++column)
      fit.views[0].uv_px.emplace_back(MiddleOf(column, 1200, 12), MiddleOf(row, 900, 9));
  return fit;
}

Eigen::Vector2d MiddleOfField(const LensChange& change, std::size_t i) {
  const int column = static_cast<int>(i) % change.columns, row = static_cast<int>(i) / change.columns;
  return {MiddleOf(column, change.width_px, change.columns), MiddleOf(row, change.height_px, change.rows)};
}

TEST(ChangeOfLens, OfAFocalLengthGrowsFromTheMiddle) {
  const CameraIntrinsics before{700, 700, 599.5, 449.5}, now{707, 707, 599.5, 449.5};
  const auto change = ChangeOfLens(Camera(before), Camera(now));
  ASSERT_TRUE(change);
  ASSERT_EQ(change->shift_px.size(), 108U);
  EXPECT_LT(change->turn_rad, 1e-9);
  for (std::size_t i = 0; i < 108; ++i) {
    const Eigen::Vector2d wanted = 0.01 * (MiddleOfField(*change, i) - Eigen::Vector2d(599.5, 449.5));
    EXPECT_LT((*change->shift_px[i] - wanted).norm(), 1e-6) << i;
  }
}

TEST(ChangeOfLens, OfNothingIsNone) {
  const CameraIntrinsics lens{700, 690, 590, 460, {-0.2, 0.05, 0.001, -0.002, 0.0}};
  const auto change = ChangeOfLens(Camera(lens), Camera(lens));
  ASSERT_TRUE(change);
  for (const auto& shift_px : change->shift_px) EXPECT_LT(shift_px->norm(), 1e-6);
}

// A principal point that went aside is a turn, but for what a flat picture makes of it.
TEST(ChangeOfLens, LeavesOutTheTurnThatExplainsMost) {
  const CameraIntrinsics before{700, 690, 590, 460, {-0.2, 0.05, 0.001, -0.002, 0.0}};
  CameraIntrinsics now = before;
  now.cx_px += 8, now.cy_px -= 5, now.distortion[0] += 0.003;
  const auto change = ChangeOfLens(Camera(before), Camera(now));
  ASSERT_TRUE(change);
  std::vector<Eigen::Vector3d> rays;
  for (std::size_t i = 0; i < 108; ++i)
    rays.push_back(*Unproject(CameraModel::kPinholeRadtan, VectorOf(before), MiddleOfField(*change, i)));
  const auto shifts = [&](const Eigen::VectorXd& turn) {
    const double angle = std::max(turn.norm(), 1e-300);
    const Eigen::Matrix3d R = Eigen::AngleAxisd(angle, Eigen::Vector3d(turn / angle)).toRotationMatrix();
    Eigen::VectorXd r(216);
    for (Eigen::Index i = 0; i < 108; ++i) {
      const auto field = static_cast<std::size_t>(i);
      r.segment<2>(2 * i) = Pixel(Numbers(now), R * rays[field]) - MiddleOfField(*change, field);
    }
    return r;
  };
  const Eigen::VectorXd turn = LeastSquares(3, shifts), wanted = shifts(turn);
  EXPECT_NEAR(change->turn_rad, turn.norm(), 1e-7);
  for (Eigen::Index i = 0; i < 108; ++i)
    EXPECT_LT((*change->shift_px[static_cast<std::size_t>(i)] - wanted.segment<2>(2 * i)).norm(), 1e-4) << i;
  EXPECT_LT(wanted.cwiseAbs().maxCoeff(), 8.0);
}

// The turn is sought where both saw corners: there the change is least.
TEST(ChangeOfLens, FitsTheTurnWhereBothSawCorners) {
  const CameraIntrinsics before{700, 700, 599.5, 449.5}, now{721, 721, 599.5, 449.5};
  const auto right = ChangeOfLens(Camera(before), Camera(now, 8));
  ASSERT_TRUE(right);
  double of_seen = 0.0, of_others = 0.0;
  for (std::size_t i = 0; i < 108; ++i) {
    ASSERT_EQ(right->seen[i], i % 12 >= 8) << i;
    (right->seen[i] ? of_seen : of_others) += std::abs(right->shift_px[i]->x()) / (right->seen[i] ? 36 : 72);
  }
  EXPECT_LT(of_seen, 0.35 * of_others);
}

TEST(ChangeOfLens, IsNotToldOfPicturesOfAnotherSizeOrWithoutIntrinsics) {
  const CameraFit whole = Camera({700, 700, 599.5, 449.5});
  CameraFit other = whole;
  other.width_px = 1201;
  EXPECT_FALSE(ChangeOfLens(whole, other));
  other = whole;
  other.source = IntrinsicsSource::kNone;
  EXPECT_FALSE(ChangeOfLens(other, whole));
  EXPECT_FALSE(ChangeOfLens(whole, other));
  EXPECT_TRUE(ChangeOfLens(whole, whole));
}

}  // namespace
}  // namespace rigcal::calib
