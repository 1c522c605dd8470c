// The fast projection against calib's, for every lens.
#include "server/cloud/lens.h"

#include <gtest/gtest.h>

#include <random>

#include "server/calib/camera/projection.h"

namespace rigcal::cloud {
namespace {

struct LensCase {
  const char* name;
  CameraIntrinsics intrinsics;
};

std::vector<LensCase> Cases() {
  return {
      {"plain", {900, 910, 640, 480, {0, 0, 0, 0, 0}, CameraModel::kPinholeRadtan}},
      {"radtan", {900, 910, 640, 480, {-0.31, 0.12, 0.001, -0.002, -0.02}, CameraModel::kPinholeRadtan}},
      {"rational",
       {500, 505, 640, 480, {0.9, 0.2, 0.0004, -0.0003, 0.01, 1.2, 0.45, 0.04}, CameraModel::kPinholeRational}},
      {"fisheye", {420, 421, 960, 600, {-0.02, 0.005, -0.003, 0.0006}, CameraModel::kFisheyeKb4}},
      {"eucm", {420, 421, 960, 600, {0.63, 1.1}, CameraModel::kEucm}},
      {"double_sphere", {330, 331, 960, 600, {-0.2, 0.59}, CameraModel::kDoubleSphere}},
      {"narrow_sphere", {700, 701, 640, 480, {0.3, 0.2}, CameraModel::kDoubleSphere}},
      {"missing", {900, 900, 640, 480, {}, CameraModel::kPinholeRadtan}},
  };
}

TEST(Lens, AgreesWithCalibOnEveryModel) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> side(-6, 6);
  for (const LensCase& lens_case : Cases()) {
    const Lens lens(lens_case.intrinsics);
    const calib::IntrinsicsVector vector = calib::VectorOf(lens_case.intrinsics);
    int seen = 0, differ = 0;
    for (int i = 0; i < 20000; ++i) {
      const Eigen::Vector3f p(side(random), side(random), side(random));
      const auto exact = calib::Project(lens_case.intrinsics.model, vector, p.cast<double>(), false);
      Eigen::Vector2f uv;
      const bool fast = lens.Project(p, uv) && uv.norm() < 4000;
      const bool slow = exact.in_front && exact.uv_px.norm() < 4000;
      differ += fast != slow ? 1 : 0;  // only within the step that finds the fold
      if (!fast || !slow) continue;
      ++seen;
      EXPECT_NEAR(uv.x(), exact.uv_px.x(), 0.02) << lens_case.name << " " << p.transpose();
      EXPECT_NEAR(uv.y(), exact.uv_px.y(), 0.02) << lens_case.name << " " << p.transpose();
    }
    EXPECT_GT(seen, 1000) << lens_case.name;
    EXPECT_LE(differ, 40) << lens_case.name;
  }
}

TEST(Lens, ForAPictureOnlyWhatLiesOutsideIsLeftOut) {
  std::mt19937 random(8);
  std::uniform_real_distribution<float> side(-6, 6);
  for (const LensCase& lens_case : Cases()) {
    const Lens all(lens_case.intrinsics), some(lens_case.intrinsics, 1280, 960);
    for (int i = 0; i < 20000; ++i) {
      const Eigen::Vector3f p(side(random), side(random), side(random));
      Eigen::Vector2f a, b;
      if (!all.Project(p, a) || a.minCoeff() < 0 || a.x() > 1280 || a.y() > 960) continue;
      ASSERT_TRUE(some.Project(p, b)) << lens_case.name << " " << p.transpose();
      EXPECT_EQ(a, b);
    }
  }
}

TEST(Lens, WhatIsNoPointIsNotSeen) {
  const float nan = std::nanf(""), inf = std::numeric_limits<float>::infinity();
  for (const LensCase& lens_case : Cases()) {
    const Lens lens(lens_case.intrinsics);
    Eigen::Vector2f uv;
    for (const Eigen::Vector3f& p :
         {Eigen::Vector3f(nan, 0, 1), Eigen::Vector3f(0, 0, nan), Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(inf, 0, 1)})
      EXPECT_FALSE(lens.Project(p, uv) && uv.allFinite() && uv.norm() < 1e4F) << lens_case.name << " " << p.transpose();
    ASSERT_TRUE(lens.Project({0, 0, 1}, uv));
    EXPECT_NEAR(uv.x(), lens_case.intrinsics.cx_px, 1e-3);
  }
}

}  // namespace
}  // namespace rigcal::cloud
