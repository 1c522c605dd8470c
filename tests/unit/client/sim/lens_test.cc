// The simulation's lens against the calibration's own: two implementations that share no code.
#include "client/sim/rig/lens.h"

#include <gtest/gtest.h>

#include "server/calib/camera/projection.h"

namespace rigcal::sim {
namespace {

const CameraIntrinsics kRadtan{600, 605, 318, 243, {-0.12, 0.05, 0.002, -0.001, 0.01}, CameraModel::kPinholeRadtan};
const CameraIntrinsics kRational{
    600, 605, 318, 243, {0.3, 0.05, 0.001, -0.001, 0.01, 0.4, 0.1, 0.02}, CameraModel::kPinholeRational};
const CameraIntrinsics kFisheye{300, 302, 318, 243, {-0.03, 0.01, -0.004, 0.001}, CameraModel::kFisheyeKb4};

const CameraIntrinsics kEucm{300, 302, 318, 243, {0.63, 1.2}, CameraModel::kEucm};
const CameraIntrinsics kDoubleSphere{240, 242, 318, 243, {-0.2, 0.59}, CameraModel::kDoubleSphere};

const std::vector<Eigen::Vector3d> kPoints = {{0.3, -0.2, 2.0}, {-0.6, 0.5, 1.5}, {0.9, 0.7, 2.1}, {0.01, 0.4, 3.0}};

TEST(SimLens, SeesPointsWhereTheCalibrationSeesThem) {
  for (const CameraIntrinsics& camera : {kRadtan, kRational, kFisheye, kEucm, kDoubleSphere}) {
    const auto seen = PixelsWithDerivatives(camera, kPoints);
    ASSERT_EQ(seen.size(), kPoints.size());
    for (std::size_t i = 0; i < kPoints.size(); ++i) {
      const auto expected = calib::Project(camera.model, calib::VectorOf(camera), kPoints[i]);
      ASSERT_TRUE(expected.in_front);
      EXPECT_LT((seen[i].uv_px - expected.uv_px).norm(), 1e-9) << NameOf(camera.model);
      EXPECT_LT((seen[i].d_point - expected.d_point).norm(), 1e-6 * expected.d_point.norm()) << NameOf(camera.model);
      const auto count = seen[i].d_intrinsics.cols();
      ASSERT_EQ(count, calib::IntrinsicsCount(camera.model));
      EXPECT_LT((seen[i].d_intrinsics - expected.d_intrinsics.leftCols(count)).norm(),
                1e-6 * expected.d_intrinsics.norm())
          << NameOf(camera.model);
    }
  }
}

TEST(SimLens, RaysGoThroughThePointsOfTheirPixels) {
  for (const CameraIntrinsics& camera : {kRadtan, kRational, kFisheye, kEucm, kDoubleSphere}) {
    const auto rays = RaysOf(camera, PixelsOf(camera, kPoints));
    ASSERT_EQ(rays.size(), kPoints.size());
    for (std::size_t i = 0; i < rays.size(); ++i)
      EXPECT_LT((rays[i].normalized() - kPoints[i].normalized()).norm(), 1e-8) << NameOf(camera.model);
  }
}

// As far out as the calibration says that points are seen, and no farther.
TEST(SimLens, SphereModelsEndWhereTheCalibrationEndsThem) {
  for (const CameraIntrinsics& camera :
       {kEucm, kDoubleSphere, CameraIntrinsics{300, 300, 318, 243, {0.3, 0.8}, CameraModel::kEucm},
        CameraIntrinsics{300, 300, 318, 243, {0.3, 0.8}, CameraModel::kDoubleSphere},
        CameraIntrinsics{300, 300, 318, 243, {-0.6, 0.3}, CameraModel::kDoubleSphere}}) {
    const calib::IntrinsicsVector numbers = calib::VectorOf(camera);
    double last_rad = 0, seen_rad = 0, before_px = 0;
    for (double angle_rad = 0.002; angle_rad < M_PI; angle_rad += 0.002) {
      const Eigen::Vector3d ray(0, std::sin(angle_rad), std::cos(angle_rad));
      const double out_px = PixelsOf(camera, {ray})[0].y() - camera.cy_px;
      if (out_px > before_px && last_rad + 0.003 > angle_rad) last_rad = angle_rad, before_px = out_px;
      if (calib::Project(camera.model, numbers, ray, false).in_front) seen_rad = angle_rad;
    }
    EXPECT_NEAR(last_rad, seen_rad, 0.0021) << NameOf(camera.model) << " " << camera.distortion[0];
    EXPECT_GT(last_rad, 1.2) << NameOf(camera.model);
    EXPECT_LT(last_rad, 2.4) << NameOf(camera.model);
  }
}

TEST(SimLens, SphereModelsSeeBesideThemselves) {
  const std::vector<Eigen::Vector3d> beside = {{1, 0.2, -0.1}, {0.1, -1, 0.02}, {-0.6, 0.7, -0.3}};
  for (const CameraIntrinsics& camera : {kEucm, kDoubleSphere}) {
    const auto pixels = PixelsOf(camera, beside);
    const auto rays = RaysOf(camera, pixels);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      EXPECT_LT((rays[i].normalized() - beside[i].normalized()).norm(), 1e-8) << NameOf(camera.model);
      const auto back = calib::Unproject(camera.model, calib::VectorOf(camera), pixels[i]);
      ASSERT_TRUE(back);
      EXPECT_LT((*back - beside[i].normalized()).norm(), 1e-8) << NameOf(camera.model);
    }
  }
}

TEST(SimLens, ASmallerPictureShowsTheSameThings) {
  const auto full = PixelsOf(kRadtan, kPoints), half = PixelsOf(Scaled(kRadtan, 0.5), kPoints);
  for (std::size_t i = 0; i < full.size(); ++i) {
    const Eigen::Vector2d expected = (full[i] + Eigen::Vector2d::Constant(0.5)) * 0.5 - Eigen::Vector2d::Constant(0.5);
    EXPECT_LT((half[i] - expected).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace rigcal::sim
