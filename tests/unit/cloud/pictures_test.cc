// The rendered views and overlays, pixel by pixel where it matters.
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "server/cloud/overlay.h"
#include "server/cloud/render.h"
#include "tests/bench/sensors/cloud_room.h"

namespace rigcal::cloud {
namespace {

cv::Mat Decoded(const std::string& bytes) {
  return cv::imdecode(std::vector<std::uint8_t>(bytes.begin(), bytes.end()), cv::IMREAD_COLOR);
}

// The room in its own colours, as if cameras saw everything.
ColouredCloud Painted(const CloudRoom& room, std::size_t count) {
  std::vector<int> surfaces;
  Beams beams = BeamsOf(room.Scan(count, surfaces));
  ColouredCloud cloud = Blend(std::move(beams), {});
  for (std::size_t i = 0; i < count; ++i) cloud.rgb[i] = room.ColourOf(surfaces[i]), cloud.camera_idx[i] = 0;
  cloud.covered = count;
  return cloud;
}

// Of the picture where a place of the room is, as r g b.
Rgb PixelAt(const cv::Mat& picture, const ColouredCloud& cloud, Angle angle, const Eigen::Vector3f& place_m) {
  const Viewpoint view = ViewpointOf(cloud.points_m, {}, angle, picture.cols, picture.rows);
  const Eigen::Vector3f at = view.Place(view.R_view_lidar * place_m, picture.cols, picture.rows);
  const cv::Vec3b bgr = picture.at<cv::Vec3b>(static_cast<int>(at.y()), static_cast<int>(at.x()));
  return {bgr[2], bgr[1], bgr[0]};
}

void ExpectNear(const Rgb& found, const Rgb& wanted, const char* what) {
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(found[c], wanted[c], 24) << what << " colour " << c;
}

TEST(Render, EverySurfaceIsWhereItBelongs) {
  const CloudRoom room;
  const ColouredCloud cloud = Painted(room, 300'000);
  const cv::Mat front = Decoded(RenderPng(cloud, {}, Angle::kFront));
  ASSERT_EQ(front.size(), cv::Size(1280, 800));
  ExpectNear(PixelAt(front, cloud, Angle::kFront, {4, 0.5F, 0.2F}), room.ColourOf(1), "front wall");
  ExpectNear(PixelAt(front, cloud, Angle::kFront, {3.6F, 3, 0.2F}), room.ColourOf(3), "left wall");
  const cv::Mat top = Decoded(RenderPng(cloud, {}, Angle::kTop));
  ExpectNear(PixelAt(top, cloud, Angle::kTop, {2, 1, -1.2F}), room.ColourOf(4), "the floor, through the ceiling");
  const cv::Mat oblique = Decoded(RenderPng(cloud, {}, Angle::kOblique));
  ExpectNear(PixelAt(oblique, cloud, Angle::kOblique, {4, -1, 0.2F}), room.ColourOf(1), "the far wall");
  ExpectNear(PixelAt(oblique, cloud, Angle::kOblique, {-1, -1, -1.2F}), room.ColourOf(4), "the floor, through a wall");
}

TEST(Render, TheNearerSurfaceWins) {
  CloudRoom room;
  room.plates.push_back({{2, 0, 0.3}, {0, 0.3, 0}, {0, 0, 0.3}, {250, 20, 250}});
  const ColouredCloud cloud = Painted(room, 300'000);
  const cv::Mat front = Decoded(RenderPng(cloud, {}, Angle::kFront));
  ExpectNear(PixelAt(front, cloud, Angle::kFront, {2, 0.05F, 0.3F}), {250, 20, 250}, "plate");
}

TEST(Render, TheBarIsAsLongAsItSays) {
  const ColouredCloud cloud = Painted(CloudRoom(), 100'000);
  const cv::Mat top = Decoded(RenderPng(cloud, {}, Angle::kTop));
  const Viewpoint view = ViewpointOf(cloud.points_m, {}, Angle::kTop, top.cols, top.rows);
  int first = top.cols, last = 0;
  for (int x = 0; x < top.cols / 2; ++x) {
    const cv::Vec3b bgr = top.at<cv::Vec3b>(top.rows - 24, x);
    if (std::min({bgr[0], bgr[1], bgr[2]}) > 220) first = std::min(first, x), last = std::max(last, x);
  }
  const double length_m = (last - first) / static_cast<double>(view.scale_px);
  EXPECT_NEAR(length_m, std::round(length_m), 4 / static_cast<double>(view.scale_px));  // 1 or 2 m in a room
  EXPECT_GE(std::lround(length_m), 1);
}

TEST(Render, LightAndDarkAndNothing) {
  RenderOptions light;
  light.background = Background::kLight;
  const cv::Mat dark = Decoded(RenderPng({}, {}, Angle::kFront));
  const cv::Mat bright = Decoded(RenderPng({}, {}, Angle::kFront, light));
  ASSERT_EQ(dark.size(), cv::Size(1280, 800));
  EXPECT_LT(cv::mean(dark)[0], 80);
  EXPECT_GT(cv::mean(bright)[0], 200);
}

TEST(Stand, FollowsWhatIsGivenAndFallsBackOnTheLidar) {
  const Stand tilted = StandOf({0, -1, 0}, {1, 0.5, 0});
  EXPECT_NEAR(tilted.up.y(), -1, 1e-6);
  EXPECT_NEAR(tilted.forward.x(), 1, 1e-6);  // level: the part along up is gone
  const Stand nothing = StandOf({0, 0, 0}, {0, 0, 0});
  EXPECT_EQ(nothing.up, Eigen::Vector3f::UnitZ());
  EXPECT_EQ(nothing.forward, Eigen::Vector3f::UnitX());
}

// A wall on the left alone: ahead there is nothing to see. What shows nearly as much stays where it is.
TEST(Stand, FacesWhereMostPointsAre) {
  std::vector<Eigen::Vector3f> wall;
  for (int i = 0; i < 900; ++i) wall.emplace_back(-1.0F + 2.0F * (i % 30) / 29, 3.0F, -1.0F + 2.0F * (i / 30) / 29);
  const Stand turned = FacingMost(Stand{}, wall);
  EXPECT_GT(turned.forward.y(), 0.7);
  EXPECT_NEAR(turned.forward.norm(), 1, 1e-5);
  std::vector<Eigen::Vector3f> both = wall;
  for (std::size_t i = 0; i < 700; ++i) both.emplace_back(3.0F, wall[i].x(), wall[i].z());
  EXPECT_NEAR(FacingMost(Stand{}, both).forward.x(), 1, 1e-5);
  EXPECT_EQ(FacingMost(Stand{}, {}).forward, Eigen::Vector3f::UnitX());
}

TEST(Overlay, PointsLieWhereTheyAreAndBothPicturesHaveOneSize) {
  const int width = 2000, height = 1000;
  const Picture picture{width, height, std::vector<std::uint8_t>(3 * width * height, 90)};
  Cloud near_and_far;
  for (int i = 0; i < 40; ++i) near_and_far.points_m.emplace_back(2.0F, 0.02F * static_cast<float>(i) + 0.1F, 0.2F);
  for (int i = 0; i < 40; ++i) near_and_far.points_m.emplace_back(20.0F, -0.2F * static_cast<float>(i) - 1, 2.0F);
  const CameraView view = See(BeamsOf(near_and_far), RoomCamera({0, 0, 0}, 0, width, height, 800), picture);
  ASSERT_EQ(view.Count(), 80u);
  const Overlay overlay = OverlayOf(picture, view);
  const cv::Mat points = Decoded(overlay.points_jpg), plain = Decoded(overlay.picture_jpg);
  EXPECT_EQ(points.size(), cv::Size(1600, 800));
  EXPECT_EQ(plain.size(), points.size());
  const auto at = [&](float u, float v) {
    return points.at<cv::Vec3b>(static_cast<int>(std::lround(0.8F * v)), static_cast<int>(std::lround(0.8F * u)));
  };
  const SeenPoint &near_point = view.parts[0][20], &far_point = view.parts[0][60];
  const cv::Vec3b light = at(near_point.u_px, near_point.v_px), dark = at(far_point.u_px, far_point.v_px);
  EXPECT_GT(light[2], 180);  // yellow: red and green, little blue
  EXPECT_GT(light[1], 150);
  EXPECT_LT(light[0], 120);
  EXPECT_GT(dark[0], dark[1] + 60);  // violet: blue more than green
}

}  // namespace
}  // namespace rigcal::cloud
