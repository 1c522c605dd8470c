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

const std::vector<Eigen::Vector3d> kPoints = {{0.3, -0.2, 2.0}, {-0.6, 0.5, 1.5}, {0.9, 0.7, 2.1}, {0.01, 0.4, 3.0}};

TEST(SimLens, SeesPointsWhereTheCalibrationSeesThem) {
  for (const CameraIntrinsics& camera : {kRadtan, kRational, kFisheye}) {
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
  for (const CameraIntrinsics& camera : {kRadtan, kRational, kFisheye}) {
    const auto rays = RaysOf(camera, PixelsOf(camera, kPoints));
    ASSERT_EQ(rays.size(), kPoints.size());
    for (std::size_t i = 0; i < rays.size(); ++i)
      EXPECT_LT((rays[i].normalized() - kPoints[i].normalized()).norm(), 1e-8) << NameOf(camera.model);
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
