#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "server/detect/clouds/cloud_board.h"

namespace rigcal::detect {
namespace {

using testing::HasSubstr;

Target Board() {
  Target board{TargetId("board"), 7, 5, 0.095, 0.0, ""};
  board.plate_m = Eigen::Vector2d(0.85, 0.61);
  return board;
}

template <typename Make>
Cloud CloudOf(int count, Make make) {
  Cloud cloud;
  for (int i = 0; i < count; ++i) cloud.points_m.push_back(make(i));
  return cloud;
}

void ExpectNothing(const Cloud& cloud, const std::string& why) {
  const AnnotatedCloud found = DetectPlate(cloud, Board());
  EXPECT_FALSE(found.view.found);
  EXPECT_TRUE(found.view.candidates.empty());
  EXPECT_THAT(found.view.why_not, HasSubstr(why));
  EXPECT_EQ(found.view.points, cloud.points_m.size());
  EXPECT_EQ(found.view.target.str(), "board");
  EXPECT_FALSE(found.picture.empty());
}

TEST(DetectCloudDegenerate, EmptyCloud) { ExpectNothing({}, "no points"); }

TEST(DetectCloudDegenerate, OnePoint) {
  ExpectNothing(CloudOf(1, [](int) { return Eigen::Vector3f(1, 2, 3); }), "too few");
}

TEST(DetectCloudDegenerate, PointsAllEqual) {
  ExpectNothing(CloudOf(5000, [](int) { return Eigen::Vector3f(1, 2, 3); }), "no flat patch");
}

TEST(DetectCloudDegenerate, PointsOnALine) {
  const auto on_line = [](int i) { return Eigen::Vector3f(3, 0.001f * static_cast<float>(i), 0.5f); };
  ExpectNothing(CloudOf(5000, on_line), "no flat patch");
}

TEST(DetectCloudDegenerate, OneRing) {
  const auto ring = [](int i) {
    const float angle = 0.003f * static_cast<float>(i);
    return Eigen::Vector3f(4 * std::cos(angle), 4 * std::sin(angle), 0);
  };
  ExpectNothing(CloudOf(2000, ring), "no flat patch");
}

TEST(DetectCloudDegenerate, PointsFarAway) {
  const auto far = [](int i) { return Eigen::Vector3f(1e5f, static_cast<float>(i), static_cast<float>(i % 7)); };
  ExpectNothing(CloudOf(5000, far), "metre");
}

TEST(DetectCloudDegenerate, PointsAtTheOriginHugeAndNotFinite) {
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Eigen::Vector3f> bad = {{0, 0, 0}, {3e38f, 3e38f, 3e38f}, {inf, 0, 0}, {nan, 1, 1}, {1, 1, -inf}};
  ExpectNothing(CloudOf(1000, [&](int i) { return bad[static_cast<std::size_t>(i) % bad.size()]; }), "too few");
}

TEST(DetectCloudDegenerate, ABlobWithoutPlanes) {
  const auto blob = [](int i) {
    const auto t = static_cast<float>(i);
    return Eigen::Vector3f(3 + std::sin(t * 12.9898f), 2 * std::cos(t * 78.233f), std::sin(t * 37.719f));
  };
  ExpectNothing(CloudOf(20'000, blob), "no flat patch");
}

TEST(DetectCloudDegenerate, AMillionPointsAreSampledAndAllOfThePlateIsGiven) {
  // A plate alone, as dense as a survey scanner sees it.
  const auto on_plate = [](int i) {
    return Eigen::Vector3f(3, -0.425f + 0.85f * static_cast<float>(i % 1000) / 999,
                           0.305f - 0.61f * static_cast<float>(i / 1000) / 999);
  };
  const AnnotatedCloud found = DetectPlate(CloudOf(1'000'000, on_plate), Board());
  ASSERT_TRUE(found.view.found) << found.view.why_not;
  EXPECT_GT(found.view.candidates.front().points_m.size(), 800'000u);
  EXPECT_NEAR(found.view.candidates.front().extent_m.x(), 0.81, 0.03);
  EXPECT_NEAR(found.view.candidates.front().extent_m.y(), 0.57, 0.03);
}

TEST(DetectCloudDegenerate, PlatesThatNoCloudCanShow) {
  for (const Eigen::Vector2d& plate_m :
       {Eigen::Vector2d(0.01, 0.01), Eigen::Vector2d(50, 50), Eigen::Vector2d(6, 0.1), Eigen::Vector2d(NAN, 1),
        Eigen::Vector2d(INFINITY, 1), Eigen::Vector2d(-1, 1)}) {
    Target board = Board();
    board.plate_m = plate_m;
    const AnnotatedCloud found = DetectPlate(CloudOf(10, [](int) { return Eigen::Vector3f(1, 2, 3); }), board);
    EXPECT_FALSE(found.view.found);
    EXPECT_THAT(found.view.why_not, HasSubstr("plate_size_m"));
  }
}

TEST(DetectCloudDegenerate, TheKeyNamesPlateAndTarget) {
  Target other = Board();
  other.plate_m = Eigen::Vector2d(0.85, 0.62);
  EXPECT_NE(CloudDetectorKey(Board()), CloudDetectorKey(other));
  other = Board();
  other.id = TargetId("other");
  EXPECT_NE(CloudDetectorKey(Board()), CloudDetectorKey(other));
  other = Board();
  other.plate_m.reset();
  EXPECT_NE(CloudDetectorKey(Board()), CloudDetectorKey(other));
}

}  // namespace
}  // namespace rigcal::detect
