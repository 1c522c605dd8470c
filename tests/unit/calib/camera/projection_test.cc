// Every camera model: values against OpenCV, of the sphere models against the papers' formulas as they stand there,
// derivatives against differences, and the way back.
#include "server/calib/camera/projection.h"

#include <gmock/gmock.h>

#include <opencv2/calib3d.hpp>
#include <random>

namespace rigcal::calib {
namespace {

constexpr std::array kModels = {CameraModel::kPinholeRadtan, CameraModel::kPinholeRational, CameraModel::kFisheyeKb4,
                                CameraModel::kEucm, CameraModel::kDoubleSphere};

CameraIntrinsics TypicalLens(CameraModel model) {
  if (model == CameraModel::kPinholeRadtan) return {610, 590, 322, 238, {-0.28, 0.09, 0.004, -0.007, 0.02}, model};
  if (model == CameraModel::kPinholeRational)
    return {610, 590, 322, 238, {0.4, -0.06, 0.004, -0.007, 0.01, 0.7, 0.05, -0.02}, model};
  if (model == CameraModel::kEucm) return {310, 300, 322, 238, {0.62, 1.13}, model};
  if (model == CameraModel::kDoubleSphere) return {250, 240, 322, 238, {-0.21, 0.59}, model};
  return {310, 300, 322, 238, {-0.02, 0.03, -0.02, 0.004}, model};
}

// Khomutenko et al. (2016), equations of the projection; Usenko et al. (2018), equations 40 to 42.
Eigen::Vector2d ByThePapers(const CameraIntrinsics& lens, const Eigen::Vector3d& p) {
  const double first = lens.distortion[0], second = lens.distortion[1], x2y2 = p.x() * p.x() + p.y() * p.y();
  double divisor = 0;
  if (lens.model == CameraModel::kEucm) {
    divisor = first * std::sqrt(second * x2y2 + p.z() * p.z()) + (1 - first) * p.z();
  } else {
    const double d1 = std::sqrt(x2y2 + p.z() * p.z());
    const double d2 = std::sqrt(x2y2 + std::pow(first * d1 + p.z(), 2));
    divisor = second * d2 + (1 - second) * (first * d1 + p.z());
  }
  return {lens.fx_px * p.x() / divisor + lens.cx_px, lens.fy_px * p.y() / divisor + lens.cy_px};
}

Eigen::Vector2d Expected(const CameraIntrinsics& lens, const Eigen::Vector3d& p_cam) {
  if (IsSphere(lens.model)) return ByThePapers(lens, p_cam);
  const cv::Matx33d K(lens.fx_px, 0, lens.cx_px, 0, lens.fy_px, lens.cy_px, 0, 0, 1);
  const std::vector<cv::Point3d> points{{p_cam.x(), p_cam.y(), p_cam.z()}};
  const cv::Vec3d zero(0, 0, 0);
  std::vector<cv::Point2d> pixels;
  if (lens.model == CameraModel::kFisheyeKb4)
    cv::fisheye::projectPoints(points, pixels, zero, zero, K, lens.distortion);
  else
    cv::projectPoints(points, zero, zero, K, lens.distortion, pixels);
  return {pixels[0].x, pixels[0].y};
}

const std::vector<Eigen::Vector3d> kPoints = {{0.21, -0.13, 0.7}, {-0.4, 0.3, 0.9}, {1e-7, -2e-7, 0.5},
                                              {0, 0, 0.8},        {0, 0.2, 0.6},    {-0.3, 0, 1.4}};

class Models : public testing::TestWithParam<CameraModel> {
 protected:
  CameraModel model_ = GetParam();
  CameraIntrinsics lens_ = TypicalLens(GetParam());
  IntrinsicsVector values_ = VectorOf(lens_);
};
INSTANTIATE_TEST_SUITE_P(All, Models, testing::ValuesIn(kModels),
                         [](const auto& tested) { return NameOf(tested.param); });

TEST_P(Models, AgreesWithAnotherProgramOrThePaper) {
  for (const Eigen::Vector3d& p_cam : kPoints) {
    const Projection projection = Project(model_, values_, p_cam);
    ASSERT_TRUE(projection.in_front) << p_cam.transpose();
    EXPECT_LT((projection.uv_px - Expected(lens_, p_cam)).norm(), 1e-9) << p_cam.transpose();
  }
}

TEST_P(Models, DerivativesByThePointAreThoseOfDifferences) {
  for (const Eigen::Vector3d& p_cam : kPoints)
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d step = 1e-6 * Eigen::Vector3d::Unit(i);
      const Eigen::Vector2d slope =
          (Project(model_, values_, p_cam + step).uv_px - Project(model_, values_, p_cam - step).uv_px) / 2e-6;
      EXPECT_LT((slope - Project(model_, values_, p_cam).d_point.col(i)).norm(), 1e-5 * (1 + slope.norm()))
          << p_cam.transpose() << " axis " << i;
    }
}

TEST_P(Models, DerivativesByTheIntrinsicsAreThoseOfDifferences) {
  for (const Eigen::Vector3d& p_cam : kPoints) {
    const Projection projection = Project(model_, values_, p_cam);
    for (int i = 0; i < kIntrinsicsMax; ++i) {
      const IntrinsicsVector step = 1e-5 * IntrinsicsVector::Unit(i);
      const Eigen::Vector2d slope =
          (Project(model_, values_ + step, p_cam).uv_px - Project(model_, values_ - step, p_cam).uv_px) / 2e-5;
      EXPECT_LT((slope - projection.d_intrinsics.col(i)).norm(), 1e-5) << p_cam.transpose() << " parameter " << i;
    }
  }
}

TEST_P(Models, UnprojectIsTheWayBack) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> sideways(-1, 1);
  for (int n = 0; n < 500; ++n) {
    const Eigen::Vector3d ray = Eigen::Vector3d(sideways(random), 0.7 * sideways(random), 1).normalized();
    const Projection projection = Project(model_, values_, ray);
    if (!projection.in_front) continue;
    const auto back = Unproject(model_, values_, projection.uv_px);
    ASSERT_TRUE(back) << ray.transpose();
    EXPECT_LT((*back - ray).norm(), 1e-9) << ray.transpose();
  }
  const auto axis = Unproject(model_, values_, {lens_.cx_px, lens_.cy_px});
  ASSERT_TRUE(axis);
  EXPECT_LT((*axis - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
}

TEST_P(Models, NoNumbersAreNotSeen) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(Project(model_, values_, {0.1, 0.1, nan}).in_front);
  EXPECT_FALSE(Project(model_, values_, {nan, 0.1, 1}).in_front);
  EXPECT_FALSE(Project(model_, values_, {inf, 0.1, 1}).in_front);
  EXPECT_FALSE(Project(model_, values_, {0, 0, 0}).in_front);
  EXPECT_FALSE(Project(model_, values_, {0, 0, -1}).in_front);
  EXPECT_FALSE(Unproject(model_, values_, {nan, 5}));
  EXPECT_FALSE(Unproject(model_, values_, {inf, 5}));
  EXPECT_FALSE(Unproject(model_, values_, {1e300, 5}));
  IntrinsicsVector broken = values_;
  broken[5] = nan;
  EXPECT_FALSE(Unproject(model_, broken, {300, 200}));
  EXPECT_FALSE(Project(model_, broken, {0.1, 0.1, 1}).in_front);
}

TEST_P(Models, IntrinsicsSurviveTheVector) {
  const CameraIntrinsics back = IntrinsicsOf(model_, values_);
  EXPECT_EQ(back.model, model_);
  EXPECT_EQ(back.distortion, lens_.distortion);
  EXPECT_EQ(back.cy_px, lens_.cy_px);
  EXPECT_EQ(DistortionCount(model_) + 4, static_cast<std::size_t>(IntrinsicsCount(model_)));
}

// Barrel distortion x (1 - 0.28 r^2) turns back at r = sqrt(1 / 0.84).
TEST(Fold, APinholeSeesNothingBeyondTheFold) {
  const double fold = std::sqrt(1 / 0.84);
  for (const CameraModel model : {CameraModel::kPinholeRadtan, CameraModel::kPinholeRational}) {
    const IntrinsicsVector values = VectorOf({600, 600, 320, 240, {-0.28}, model});
    EXPECT_TRUE(Project(model, values, {0.999 * fold, 0, 1}).in_front);
    EXPECT_FALSE(Project(model, values, {1.001 * fold, 0, 1}).in_front);
    const double rim_px = 600 * fold * (1 - 0.28 * fold * fold);
    EXPECT_TRUE(Unproject(model, values, {320 + 0.999 * rim_px, 240}));
    EXPECT_FALSE(Unproject(model, values, {320 + 1.001 * rim_px, 240}));
  }
}

// 1 + 3 k1 s + 5 k2 s^2 is negative for s in (0.4, 0.6) only: beyond, the series grows again, and is still not seen.
TEST(Fold, WhatFoldsOnceStaysUnseen) {
  const double k1 = -1 / 0.24 / 3, k2 = 1 / 0.24 / 5;
  const IntrinsicsVector values = VectorOf({600, 600, 320, 240, {k1, k2, 0, 0, 0}, CameraModel::kPinholeRadtan});
  EXPECT_TRUE(Project(CameraModel::kPinholeRadtan, values, {std::sqrt(0.39), 0, 1}).in_front);
  EXPECT_FALSE(Project(CameraModel::kPinholeRadtan, values, {std::sqrt(0.5), 0, 1}).in_front);
  EXPECT_FALSE(Project(CameraModel::kPinholeRadtan, values, {std::sqrt(0.7), 0, 1}).in_front);
}

// A denominator that vanishes sends the point through infinity.
TEST(Fold, TheRationalModelStopsAtItsPole) {
  const CameraModel model = CameraModel::kPinholeRational;
  const IntrinsicsVector values = VectorOf({600, 600, 320, 240, {0, 0, 0, 0, 0, -1, 0, 0}, model});
  EXPECT_TRUE(Project(model, values, {0.9, 0, 1}).in_front);
  EXPECT_FALSE(Project(model, values, {1.1, 0, 1}).in_front);
}

TEST(Fisheye, SeesBeyondNinetyDegreesWhileItsSeriesGrows) {
  const CameraModel model = CameraModel::kFisheyeKb4;
  const IntrinsicsVector equidistant = VectorOf({300, 300, 640, 640, {0, 0, 0, 0}, model});
  for (const double theta_deg : {60.0, 90.0, 110.0, 170.0}) {
    const double theta = theta_deg * M_PI / 180;
    const Eigen::Vector3d ray(std::sin(theta) * 0.6, std::sin(theta) * 0.8, std::cos(theta));
    const Projection projection = Project(model, equidistant, ray);
    ASSERT_TRUE(projection.in_front);
    EXPECT_LT((projection.uv_px - Eigen::Vector2d(640 + 180 * theta, 640 + 240 * theta)).norm(), 1e-9);
    const auto back = Unproject(model, equidistant, projection.uv_px);
    ASSERT_TRUE(back) << theta_deg;
    EXPECT_LT((*back - ray).norm(), 1e-9);
  }
  // 1 - 3 * 0.2 theta^2 ends at theta = 73.97 degrees.
  const IntrinsicsVector folding = VectorOf({300, 300, 640, 640, {-0.2, 0, 0, 0}, model});
  EXPECT_TRUE(Project(model, folding, {std::sin(1.28), 0, std::cos(1.28)}).in_front);
  EXPECT_FALSE(Project(model, folding, {std::sin(1.30), 0, std::cos(1.30)}).in_front);
}

TEST(Fisheye, DerivativesHoldBeyondNinetyDegrees) {
  const CameraModel model = CameraModel::kFisheyeKb4;
  const IntrinsicsVector values = VectorOf(TypicalLens(model));
  for (const Eigen::Vector3d& p_cam : {Eigen::Vector3d(0.6, -0.5, 0), Eigen::Vector3d(0.6, 0.5, -0.2)}) {
    ASSERT_TRUE(Project(model, values, p_cam).in_front);
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d step = 1e-6 * Eigen::Vector3d::Unit(i);
      const Eigen::Vector2d slope =
          (Project(model, values, p_cam + step).uv_px - Project(model, values, p_cam - step).uv_px) / 2e-6;
      EXPECT_LT((slope - Project(model, values, p_cam).d_point.col(i)).norm(), 1e-5 * (1 + slope.norm())) << i;
    }
  }
}

// Against a dense search for the smallest value, away from polynomials that nearly touch zero.
TEST(PositiveUpTo, AgreesWithADenseSearch) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 1);
  int positive = 0;
  for (int n = 0; n < 3000; ++n) {
    Eigen::Matrix<double, 7, 1> c;
    for (int i = 0; i < 7; ++i) c[i] = i == 0 ? 1 : 3 * normal(random);
    const double s_max = std::abs(normal(random));
    double smallest = 1;
    for (int step = 0; step <= 2000; ++step) {
      double value = 0;
      for (int i = 6; i >= 0; --i) value = value * s_max * step / 2000 + c[i];
      smallest = std::min(smallest, value);
    }
    if (std::abs(smallest) < 1e-3) continue;
    EXPECT_EQ(PositiveUpTo<7>(c, s_max), smallest > 0) << c.transpose() << " up to " << s_max;
    positive += smallest > 0 ? 1 : 0;
  }
  EXPECT_GT(positive, 500);
  EXPECT_LT(positive, 2500);
}

}  // namespace
}  // namespace rigcal::calib
