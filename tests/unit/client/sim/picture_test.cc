// Pictures against the product's own search for corners, which knows nothing of how they are drawn.
#include "client/sim/views/picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "client/sim/rig/lens.h"
#include "client/sim/rig/random.h"
#include "client/sim/visit/observe.h"
#include "server/detect/board.h"
#include "tests/unit/client/sim/sample.h"

namespace rigcal::sim {
namespace {

struct Errors {
  double squares = 0;
  int count = 0, boards = 0, missed = 0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();

  [[nodiscard]] double Rms_px() const { return std::sqrt(squares / std::max(1, 2 * count)); }  // of one coordinate
};

void Compare(const Experiment& experiment, const Scene& scene, const RigSensor& camera, std::size_t capture_idx,
             PictureFormat format, Errors& errors) {
  const auto truth = TrueCorners(experiment, scene, camera, capture_idx);
  if (!truth) return;
  const Picture picture =
      TakePicture(SceneAt(experiment, capture_idx), camera.camera,
                  RayGrid(camera.camera, experiment.ShiftOf(camera.id, capture_idx)),
                  experiment.T_world_sensor(camera.id, capture_idx), KeyOf(7, "test", camera.id.str()));
  const auto bytes = Encoded(picture, format);
  ASSERT_TRUE(bytes);
  const auto found = detect::Detect(std::as_bytes(std::span(*bytes)), experiment.rig.BoardOf(*camera.sees).target);
  ++errors.boards;
  if (!found.view.found) ++errors.missed;
  for (std::size_t i = 0; i < found.view.corners_px.size(); ++i) {
    const Eigen::Vector2d error =
        found.view.corners_px[i] - (*truth)[static_cast<std::size_t>(found.view.corner_idx[i])];
    errors.squares += error.squaredNorm();
    errors.sum += error;
    ++errors.count;
  }
}

Errors ErrorsOf(const Rig& rig, const Options& options, PictureFormat format, std::size_t cameras) {
  const Experiment experiment = Prepared(rig, options);
  const Scene scene = SceneOf(experiment.rig);
  Errors errors;
  for (std::size_t i = 0; i < std::min(cameras, experiment.rig.sensors.size()); ++i) {
    const RigSensor& sensor = experiment.rig.sensors[i];
    if (sensor.kind != SensorKind::kCamera) continue;
    for (std::size_t k = 0; k < experiment.captures.size(); ++k) Compare(experiment, scene, sensor, k, format, errors);
  }
  std::cout << errors.boards << " boards, " << errors.missed << " missed, rms " << errors.Rms_px() << " px, mean "
            << (errors.sum / std::max(1, errors.count)).transpose() << " px\n";
  return errors;
}

TEST(SimPicture, CornersAreWhereGeometryPutsThemInAReducedMarsMapper) {
  Options options;
  options.scale_ratio = 0.4;
  options.captures = 2;
  const Errors errors = ErrorsOf(MarsMapper(), options, PictureFormat::kJpeg, 9);
  EXPECT_GE(errors.boards, 14);
  EXPECT_EQ(errors.missed, 0);
  EXPECT_LT(errors.Rms_px(), 0.05);
}

TEST(SimPicture, CornersAreWhereGeometryPutsThemAtFullSize) {
  Options options;
  options.captures = 1;
  const Errors errors = ErrorsOf(MarsMapper(), options, PictureFormat::kJpeg, 3);
  EXPECT_GE(errors.boards, 2);
  EXPECT_EQ(errors.missed, 0);
  EXPECT_LT(errors.Rms_px(), 0.05);
  EXPECT_LT((errors.sum / errors.count).norm(), 0.02);  // no half pixel anywhere
}

TEST(SimPicture, CornersOfAFisheyeAreWhereGeometryPutsThem) {
  Rig rig = SmallRig();
  rig.sensors[0].camera.intrinsics = {330, 331, 321, 238, {-0.03, 0.01, -0.004, 0.001}, CameraModel::kFisheyeKb4};
  Options options;
  options.captures = 4;
  const Errors errors = ErrorsOf(rig, options, PictureFormat::kPng, 1);
  EXPECT_GE(errors.boards, 3);
  EXPECT_EQ(errors.missed, 0);
  EXPECT_LT(errors.Rms_px(), 0.05);
}

// Corners of bent lenses and boards, of a board that moved, and of shifted pictures: where they are said to be.
TEST(SimPicture, CornersAreWhereDisturbancesPutThem) {
  Options options;
  options.captures = 4;
  options.disturb.lens_misfit_px = 2;
  options.disturb.board_bend_m = 0.02;
  options.disturb.capture_shift = CaptureShift{9.3, Recording{CaptureId("01"), SensorId("left")}};
  options.disturb.board_move = BoardMove{{0.05, 0.1}, 0.5, TargetId("front")};
  options.disturb.wrong_instant = WrongInstant{Recording{CaptureId("03"), SensorId("left")}};
  const Errors errors = ErrorsOf(SmallRig(), options, PictureFormat::kPng, 2);
  EXPECT_GE(errors.boards, 6);
  EXPECT_EQ(errors.missed, 0);
  EXPECT_LT(errors.Rms_px(), 0.05);
}

TEST(SimPicture, JpegMovesCornersByLessThanTheyAreKnown) {
  Options options;
  options.captures = 4;
  const Errors png = ErrorsOf(SmallRig(), options, PictureFormat::kPng, 2);
  const Errors jpeg = ErrorsOf(SmallRig(), options, PictureFormat::kJpeg, 2);
  EXPECT_EQ(png.boards, jpeg.boards);
  EXPECT_LT(jpeg.Rms_px(), png.Rms_px() + 0.01);
}

// A board that a thin pillar crosses; the pillar is drawn over it, whatever was drawn first.
TEST(SimPicture, WhatIsNearerHidesWhatIsFarther) {
  Rig rig = SmallRig();
  const Colour red(0.9, 0.1, 0.1);
  rig.room.boxes.push_back({{1.5, 0, 1}, {0.05, 0.1, 2}, 0, red});
  Options options;
  options.noise_factor = 0;
  const Experiment experiment = Prepared(rig, options);
  const RigSensor& camera = experiment.rig.sensors[0];
  const Se3 T_cam_world = experiment.T_world_sensor(camera.id, 0).Inverse();
  const Picture picture = TakePicture(SceneOf(experiment.rig), camera.camera, RayGrid(camera.camera),
                                      experiment.T_world_sensor(camera.id, 0), 1);
  for (const double z : {0.9, 1.0, 1.1}) {
    const Eigen::Vector2d uv = PixelsOf(camera.camera.intrinsics, {T_cam_world * Eigen::Vector3d(1.475, 0, z)})[0];
    const std::size_t at =
        3 * (static_cast<std::size_t>(std::lround(uv.y())) * 640 + static_cast<std::size_t>(std::lround(uv.x())));
    EXPECT_GT(picture.bgr[at + 2], 4 * picture.bgr[at]) << z;
    EXPECT_GT(picture.bgr[at + 2], 100) << z;
  }
}

TEST(SimPicture, NoiseIsAsLargeAsDeclared) {
  const Experiment experiment = Prepared(SmallRig());
  const RigSensor& camera = experiment.rig.sensors[0];
  CameraTruth quiet = camera.camera;
  quiet.noise_grey = 0;
  const Se3 T = experiment.T_world_sensor(camera.id, 0);
  const Scene scene = SceneOf(experiment.rig);
  const Picture noisy = TakePicture(scene, camera.camera, RayGrid(quiet), T, 3);
  const Picture clean = TakePicture(scene, quiet, RayGrid(quiet), T, 3);
  double squares = 0, neighbours = 0, before = 0;
  int count = 0;
  for (std::size_t i = 0; i < noisy.bgr.size(); i += 3) {
    const double error = double(noisy.bgr[i]) - double(clean.bgr[i]);
    if (clean.bgr[i] > 20 && clean.bgr[i] < 235) squares += error * error, neighbours += error * before, ++count;
    before = error;
  }
  // Both are rounded: 1/12 grey^2 each at most.
  EXPECT_NEAR(std::sqrt(squares / count), 2.0, 0.06);
  EXPECT_NEAR(neighbours / squares, 0, 0.05);
}

}  // namespace
}  // namespace rigcal::sim
