// Colouring, on scenes where every answer is known.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <set>

#include "server/base/limits.h"
#include "server/calib/camera/projection.h"
#include "server/cloud/blend.h"
#include "server/cloud/overlay.h"
#include "server/cloud/point_files.h"
#include "server/cloud/render.h"
#include "tests/bench/sensors/cloud_room.h"

namespace rigcal::cloud {
namespace {

constexpr int kWidth = 640, kHeight = 480;
constexpr std::size_t kPoints = 150'000;

CloudRoom RoomWithPlate() {
  CloudRoom room;
  room.plates.push_back({{1.8, 0.2, 0.1}, {0, 0.4, 0}, {0, 0, 0.3}, {250, 250, 20}});
  return room;
}

// The same room, its plates larger or smaller by `margin_m` on every side.
CloudRoom Grown(CloudRoom room, double margin_m) {
  for (CloudRoom::Plate& plate : room.plates) {
    plate.half_u_m *= 1 + margin_m / plate.half_u_m.norm();
    plate.half_v_m *= 1 + margin_m / plate.half_v_m.norm();
  }
  return room;
}

// Whether something in the room lies before the point, seen from the camera.
bool IsHidden(const CloudRoom& room, const CloudCamera& camera, const Eigen::Vector3f& point) {
  const Eigen::Vector3d from = camera.T_cam_lidar.Inverse().p_m, ray = point.cast<double>() - from;
  return room.Trace(from, ray).distance_m < 0.97;
}

std::set<std::uint32_t> IndicesOf(const CameraView& view) {
  std::set<std::uint32_t> indices;
  for (const auto& part : view.parts)
    for (const SeenPoint& point : part) indices.insert(point.point_idx);
  return indices;
}

TEST(Colour, WhatAPlateHidesIsNotPaintedAndNothingElseIsLost) {
  const CloudRoom room = RoomWithPlate(), larger = Grown(room, 0.05), smaller = Grown(room, -0.03);
  std::vector<int> surfaces;
  const Beams beams = BeamsOf(room.Scan(kPoints, surfaces));
  const CloudCamera camera = RoomCamera({0.1, -0.5, 0.3}, 0, kWidth, kHeight, 420);
  const CameraView view = See(beams, camera, room.Take(camera, kWidth, kHeight, 1));
  const std::set<std::uint32_t> seen = IndicesOf(view);
  std::size_t hidden = 0, free = 0, hidden_seen = 0, free_lost = 0;
  for (std::uint32_t i = 0; i < beams.points_m.size(); ++i) {
    const Eigen::Vector3d p_cam = camera.T_cam_lidar * Eigen::Vector3d(beams.points_m[i].cast<double>());
    const auto inside = calib::Project(camera.intrinsics.model, calib::VectorOf(camera.intrinsics), p_cam, false);
    if (!inside.in_front || inside.uv_px.minCoeff() < 1 || inside.uv_px.x() > kWidth - 2 ||
        inside.uv_px.y() > kHeight - 2)
      continue;
    const bool on_plate = surfaces[i] >= CloudRoom::kWallColours;
    if (!on_plate && IsHidden(smaller, camera, beams.points_m[i])) ++hidden, hidden_seen += seen.count(i);
    if (on_plate || !IsHidden(larger, camera, beams.points_m[i])) ++free, free_lost += 1 - seen.count(i);
  }
  EXPECT_GT(hidden, 500u);
  EXPECT_EQ(hidden_seen, 0u);
  EXPECT_GT(free, 10000u);
  EXPECT_LE(free_lost, free / 1000);  // grazing surfaces
}

// One ring on a plate and the next on the wall behind it fit a slope that nothing there has.
TEST(Colour, ThePlateHidesTheWallFromALidarOfFewRingsToo) {
  CloudRoom room;
  room.plates.push_back({{3.1, 0.2, 0.1}, {0, 0.4, 0}, {0, 0, 0.3}, {250, 250, 20}});
  const CloudRoom larger = Grown(room, 0.08), smaller = Grown(room, -0.05);
  std::vector<int> surfaces;
  const Beams beams = BeamsOf(room.ScanRings(1, surfaces));
  std::size_t hidden = 0, hidden_seen = 0, free = 0, free_lost = 0;
  for (const Eigen::Vector3d& place : {Eigen::Vector3d(0.1, -0.5, 0.3), {0.2, 0.1, -0.4}, {-0.1, 0.6, -0.2}}) {
    const CloudCamera camera = RoomCamera(place, 0, kWidth, kHeight, 420);
    const std::set<std::uint32_t> seen = IndicesOf(See(beams, camera, room.Take(camera, kWidth, kHeight, 1)));
    for (std::uint32_t i = 0; i < beams.points_m.size(); ++i) {
      const Eigen::Vector3d p_cam = camera.T_cam_lidar * Eigen::Vector3d(beams.points_m[i].cast<double>());
      if (surfaces[i] >= CloudRoom::kWallColours || p_cam.z() < 0.9 * p_cam.norm()) continue;
      if (IsHidden(smaller, camera, beams.points_m[i])) ++hidden, hidden_seen += seen.count(i);
      if (!IsHidden(larger, camera, beams.points_m[i])) ++free, free_lost += 1 - seen.count(i);
    }
  }
  EXPECT_GT(hidden, 200u);
  EXPECT_LE(hidden_seen, hidden / 10);  // chinks that noise makes between two rings
  EXPECT_GT(free, 10000u);
  EXPECT_LE(free_lost, free / 500);
}

TEST(Colour, EveryLensPaintsEveryPointInItsSurfacesColour) {
  const CloudRoom room;
  std::vector<int> surfaces;
  const Beams beams = BeamsOf(room.Scan(40'000, surfaces));
  const std::vector<CameraIntrinsics> lenses = {
      {260, 262, 160, 120, {-0.3, 0.1, 0.001, -0.001, -0.01}, CameraModel::kPinholeRadtan},
      {200, 201, 160, 120, {0.9, 0.2, 0.0004, -0.0003, 0.01, 1.2, 0.45, 0.04}, CameraModel::kPinholeRational},
      {110, 111, 160, 120, {-0.02, 0.005, -0.003, 0.0006}, CameraModel::kFisheyeKb4}};
  for (const CameraIntrinsics& lens : lenses) {
    CloudCamera camera = RoomCamera({0.05, 0.02, 0.1}, 0.6, 320, 240, 1);
    camera.intrinsics = lens;
    const Se3 T_lidar_cam = camera.T_cam_lidar.Inverse();
    Picture picture{320, 240, {}};
    for (int y = 0; y < 240; ++y)
      for (int x = 0; x < 320; ++x) {
        const auto ray = calib::Unproject(lens.model, calib::VectorOf(lens), {x, y});
        const Rgb rgb = ray ? room.ColourOf(room.Trace(T_lidar_cam.p_m, T_lidar_cam.R() * *ray).surface) : Rgb{};
        picture.rgb.insert(picture.rgb.end(), rgb.begin(), rgb.end());
      }
    const CameraView view = See(beams, camera, picture);
    std::size_t wrong = 0;
    for (const auto& part : view.parts)
      for (const SeenPoint& point : part) wrong += point.rgb != room.ColourOf(surfaces[point.point_idx]) ? 1 : 0;
    EXPECT_GT(view.Count(), 3000u) << NameOf(lens.model);
    EXPECT_LT(wrong, view.Count() / 25) << NameOf(lens.model);  // within a pixel of an edge of the room
  }
}

Picture Even(std::uint8_t value) { return {kWidth, kHeight, std::vector<std::uint8_t>(3 * kWidth * kHeight, value)}; }

// A few points before the cameras: too few for a balance, so the gains stay 1.
Beams FewPoints() {
  Cloud cloud;
  for (int i = -4; i <= 4; ++i) cloud.points_m.emplace_back(5.0F, 0.3F * static_cast<float>(i), 0.0F);
  return BeamsOf(cloud);
}

TEST(Colour, BlendsByTheWeights) {
  const Beams beams = FewPoints();
  const std::vector<CameraView> views = {See(beams, RoomCamera({0, 0.1, 0}, 0.3, kWidth, kHeight, 420), Even(100)),
                                         See(beams, RoomCamera({0, -0.1, 0}, -0.3, kWidth, kHeight, 420), Even(200))};
  ASSERT_EQ(views[0].Count(), 9u);
  ASSERT_EQ(views[1].Count(), 9u);
  const ColouredCloud cloud = Blend(beams, views);
  for (std::size_t i = 0; i < 9; ++i) {
    const float a = views[0].parts[0][i].weight, b = views[1].parts[0][i].weight;
    const double expected = (100.0 * a + 200.0 * b) / (a + b);
    EXPECT_NEAR(cloud.rgb[i][0], expected, 0.51);
    EXPECT_EQ(cloud.camera_idx[i], a >= b ? 0 : 1);
  }
  EXPECT_NEAR(cloud.rgb[4][1], 150, 1);         // midway between the two
  EXPECT_LT(cloud.rgb[8][1], cloud.rgb[0][1]);  // the left end is nearer to the axis of the left camera
  EXPECT_EQ(cloud.covered, 9u);
}

TEST(Colour, TheWeightFallsTowardsTheBorderAndOffTheAxis) {
  EXPECT_FLOAT_EQ(BorderWeight(320, 240, kWidth, kHeight), 1);
  EXPECT_FLOAT_EQ(BorderWeight(320, 0.08F * 480 - 0.5F, kWidth, kHeight), 1);
  EXPECT_NEAR(BorderWeight(320, 0.04F * 480 - 0.5F, kWidth, kHeight), 0.5, 1e-5);  // halfway, by symmetry
  EXPECT_FLOAT_EQ(BorderWeight(0, 240, kWidth, kHeight), 0.01F);
  EXPECT_FLOAT_EQ(BorderWeight(kWidth - 1, 240, kWidth, kHeight), 0.01F);
  const CameraView view = See(FewPoints(), RoomCamera({0, 0, 0}, 0, kWidth, kHeight, 420), Even(9));
  const auto& seen = view.parts.at(0);
  // From the lidar's own place only the angle from the axis counts: cos^2.
  const double cosine = 5 / std::hypot(5, 1.2);
  EXPECT_NEAR(seen[8].weight / seen[4].weight, cosine * cosine, 1e-4);
}

TEST(Colour, GainsAreRecoveredThoughAQuarterOfThePointsIsWrong) {
  const CloudRoom room;
  std::vector<int> surfaces;
  const Beams beams = BeamsOf(room.Scan(kPoints, surfaces));
  const std::array<double, 3> exposures = {1.0, 0.8, 0.6};
  std::vector<CameraView> views;
  for (int i = 0; i < 3; ++i) {
    const CloudCamera camera = RoomCamera({0, 0, 0.1}, 0.5 * i, kWidth, kHeight, 350);
    views.push_back(See(beams, camera, room.Take(camera, kWidth, kHeight, exposures[static_cast<std::size_t>(i)])));
  }
  for (auto& part : views[1].parts)
    for (SeenPoint& point : part)
      if (point.point_idx % 4 == 0) point.rgb = {240, 30, 130};
  const std::vector<Gain> gains = BalancedGains(views);
  const double mean = std::cbrt(1.0 * 0.8 * 0.6);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(gains[i][c] * exposures[i] / mean, 1, 0.012) << i << " " << c;
}

TEST(Colour, CamerasWithoutOverlapKeepTheirExposure) {
  const CloudRoom room;
  std::vector<int> surfaces;
  const Beams beams = BeamsOf(room.Scan(40'000, surfaces));
  std::vector<CameraView> views;
  for (const double yaw : {0.0, M_PI}) {
    const CloudCamera camera = RoomCamera({0, 0, 0}, yaw, kWidth, kHeight, 420);
    views.push_back(See(beams, camera, room.Take(camera, kWidth, kHeight, yaw > 1 ? 0.5 : 1)));
  }
  for (const Gain& gain : BalancedGains(views)) EXPECT_EQ(gain, (Gain{1, 1, 1}));
}

TEST(Colour, WhatNoCameraCoversIsGreen) {
  const CloudRoom room;
  std::vector<int> surfaces;
  Beams beams = BeamsOf(room.Scan(5'000, surfaces));
  const CloudCamera camera = RoomCamera({0, 0, 0}, 0, kWidth, kHeight, 420);
  const std::vector<CameraView> views = {See(beams, camera, room.Take(camera, kWidth, kHeight, 1))};
  const std::set<std::uint32_t> seen = IndicesOf(views[0]);
  const ColouredCloud cloud = Blend(std::move(beams), views);
  EXPECT_EQ(cloud.covered, seen.size());
  for (std::uint32_t i = 0; i < cloud.rgb.size(); ++i) {
    EXPECT_EQ(cloud.camera_idx[i], seen.count(i) ? 0 : kNoCamera);
    if (!seen.count(i)) {
      EXPECT_EQ(cloud.rgb[i], kUncovered);
    }
  }
}

TEST(Colour, NothingToColourIsNoTrouble) {
  const CloudCamera camera = RoomCamera({0, 0, 0}, 0, kWidth, kHeight, 420);
  const Beams none = BeamsOf(Cloud{});
  EXPECT_EQ(See(none, camera, Even(5)).Count(), 0u);
  EXPECT_TRUE(Blend(none, {}).points_m.empty());
  const Beams few = FewPoints();
  EXPECT_EQ(See(few, camera, Picture{}).Count(), 0u);
  const std::vector<CameraView> views = {See(few, camera, Picture{}), See(few, camera, Even(70))};
  const ColouredCloud cloud = Blend(few, views);
  EXPECT_EQ(cloud.covered, 9u);
  EXPECT_EQ(cloud.camera_idx[3], 1);
}

TEST(Colour, PointsThatAreNoneAreLeftOutAndHarmless) {
  Cloud cloud;
  const float nan = std::nanf(""), inf = std::numeric_limits<float>::infinity();
  for (const Eigen::Vector3f& point :
       {Eigen::Vector3f(nan, 1, 1), Eigen::Vector3f(5, 0, 0), Eigen::Vector3f(inf, 0, 0), Eigen::Vector3f(0, 0, 0),
        Eigen::Vector3f(9e4F, 0, 0), Eigen::Vector3f(1e-20F, 0, 0), Eigen::Vector3f(0, 0, 3)})
    cloud.points_m.push_back(point);
  const Beams beams = BeamsOf(cloud);
  ASSERT_EQ(beams.points_m.size(), 5u);
  const std::vector<CameraView> views = {See(beams, RoomCamera({0, 0, 0}, 0, kWidth, kHeight, 420), Even(70))};
  const ColouredCloud coloured = Blend(beams, views);
  for (const Eigen::Vector3f& point : coloured.points_m) EXPECT_TRUE(point.allFinite());
  EXPECT_EQ(coloured.rgb[0], (Rgb{70, 70, 70}));
  EXPECT_EQ(coloured.camera_idx[4], kNoCamera);
}

TEST(Colour, ABiggerCloudThanTheLimitIsThinnedEvenly) {
  Cloud cloud;
  cloud.points_m.assign(limits::kColouredPointsMax + 1, Eigen::Vector3f(1, 2, 3));
  const Beams beams = BeamsOf(cloud);
  EXPECT_EQ(beams.stride, 2u);
  EXPECT_EQ(beams.points_m.size(), limits::kColouredPointsMax / 2 + 1);
}

TEST(Beams, FindsTheSpacingOfRings) {
  Cloud cloud;
  for (int ring = -7; ring <= 8; ++ring)
    for (int i = 0; i < 1800; ++i) {
      const double azimuth = i * 2 * M_PI / 1800, elevation = (2 * ring - 1) * M_PI / 180;
      const Eigen::Vector3d ray(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                std::sin(elevation));
      cloud.points_m.push_back((7 * ray).cast<float>());
    }
  const Beams beams = BeamsOf(cloud);
  EXPECT_NEAR(beams.elevation_step_rad * 180 / M_PI, 2, 0.05);
  EXPECT_NEAR(beams.azimuth_step_rad * 180 / M_PI, 0.2, 0.05);
}

// Everything that is written, from one number of threads.
std::string AllBytes(std::size_t threads) {
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
  const CloudRoom room = RoomWithPlate();
  std::vector<int> surfaces;
  Beams beams = BeamsOf(room.Scan(60'000, surfaces));
  std::vector<CameraView> views;
  std::string bytes;
  for (const double yaw : {0.0, 0.7, 2.5}) {
    const CloudCamera camera = RoomCamera({0.2, 0.1, 0}, yaw, kWidth, kHeight, 420);
    const Picture picture = room.Take(camera, kWidth, kHeight, 1 - 0.1 * yaw);
    views.push_back(See(beams, camera, picture));
    bytes += OverlayOf(picture, views.back()).points_jpg;
  }
  const ColouredCloud cloud = Blend(std::move(beams), views);
  bytes += WritePly(cloud) + WriteViewerPoints(cloud);
  for (const Angle angle : {Angle::kFront, Angle::kTop, Angle::kOblique}) bytes += RenderPng(cloud, {}, angle);
  return bytes;
}

TEST(Colour, TheSameBytesFromOneAndTwoThreads) {
  const std::string one = AllBytes(1);
  EXPECT_GT(one.size(), 1'000'000u);
  EXPECT_TRUE(one == AllBytes(2));
  EXPECT_TRUE(one == AllBytes(4));
}

}  // namespace
}  // namespace rigcal::cloud
