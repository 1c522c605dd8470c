// How far the middle of a circle's picture is from the picture of its middle, and what is left of that.
#include "server/detect/circles/circle_perspective.h"

#include <gmock/gmock.h>

#include "server/detect/circles/blobs.h"
#include "tests/unit/detect/circles.h"

namespace rigcal::detect {
namespace {

// Large circles near the camera: the most that it amounts to.
Circles Large() { return {6, 5, 0.04, 0.032, false, false}; }

Scene Near(double tilt_rad, double k1) {
  Scene scene = Looking(Large().Middle_m(), 0.36, 0.4, tilt_rad, -0.4 * tilt_rad);
  scene.k1 = k1;
  return scene;
}

// Of what a camera without noise and pixels sees: 720 points of each outline, as they are.
std::vector<Eigen::Vector2d> Centroids_px(const Scene& scene, const Circles& board) {
  std::vector<Eigen::Vector2d> centroids;
  for (int idx = 0; idx < board.cols * board.rows; ++idx) {
    std::vector<Eigen::Vector2d> outline;
    for (int i = 0; i < 720; ++i) {
      const double angle = 2 * M_PI * i / 720;
      outline.push_back(
          scene.Pixel(board.Centre_m(idx) + board.diameter_m / 2 * Eigen::Vector2d(std::cos(angle), std::sin(angle))));
    }
    centroids.push_back(MomentsOf(outline).centroid);
  }
  return centroids;
}

double Largest_px(const std::vector<Eigen::Vector2d>& seen, const Scene& scene, const Circles& board) {
  double largest = 0;
  for (std::size_t i = 0; i < seen.size(); ++i)
    largest = std::max(largest, (seen[i] - scene.Pixel(board.Centre_m(static_cast<int>(i)))).norm());
  return largest;
}

TEST(CirclePerspective, IsTakenOffWhateverTheLens) {
  const Circles board = Large();
  std::vector<Eigen::Vector2d> board_m;
  for (int idx = 0; idx < board.cols * board.rows; ++idx) board_m.push_back(board.Centre_m(idx));
  for (const double k1 : {0.0, -0.25, 0.1})
    for (const double tilt_rad : {0.0, 0.3, 0.6, 0.9}) {
      const Scene scene = Near(tilt_rad, k1);
      const auto centroids_px = Centroids_px(scene, board);
      const double before_px = Largest_px(centroids_px, scene, board);
      const double after_px =
          Largest_px(CentresFrom(board_m, board.diameter_m / 2, centroids_px, {640, 480}), scene, board);
      EXPECT_GT(before_px, tilt_rad > 0.2 ? 0.2 : 0.0) << k1 << " " << tilt_rad;
      EXPECT_LT(after_px, std::max(0.004, 0.03 * before_px)) << k1 << " " << tilt_rad << " of " << before_px;
      RecordProperty("k1 " + std::to_string(k1) + " tilt " + std::to_string(tilt_rad),
                     std::to_string(before_px) + " -> " + std::to_string(after_px));
    }
}

// Few circles tell little of a lens: what is left is told here.
TEST(CirclePerspective, OfTheSmallestBoardIsMostlyTakenOff) {
  const Circles board{3, 3, 0.05, 0.03, false, false};
  std::vector<Eigen::Vector2d> board_m;
  for (int idx = 0; idx < 9; ++idx) board_m.push_back(board.Centre_m(idx));
  for (const double k1 : {0.0, -0.25, 0.1}) {
    Scene scene = Looking(board.Middle_m(), 0.36, 0.4, 0.6, -0.24, 0.05);
    scene.k1 = k1;
    const auto centroids_px = Centroids_px(scene, board);
    const double before_px = Largest_px(centroids_px, scene, board);
    const double after_px =
        Largest_px(CentresFrom(board_m, board.diameter_m / 2, centroids_px, {640, 480}), scene, board);
    EXPECT_LT(after_px, 0.05 * before_px) << k1 << " of " << before_px;
    RecordProperty("k1 " + std::to_string(k1), std::to_string(before_px) + " -> " + std::to_string(after_px));
  }
}

TEST(CirclePerspective, IsNotInWhatIsFound) {
  for (const double k1 : {0.0, -0.25}) {
    const Scene scene = Near(0.6, k1);
    const BoardView view = DetectIn(Photographed(scene, Drawn(Large())), TargetOf(Large())).view;
    ASSERT_TRUE(view.found) << view.why_not;
    double least_px = HUGE_VAL;
    for (const int quarters : {0, 2}) {
      Eigen::Vector2d mean_px = Eigen::Vector2d::Zero();
      for (const auto& [idx, at_px] : TruthTurned(scene, Large(), quarters))
        mean_px += (view.corners_px[static_cast<std::size_t>(idx)] - at_px) / view.corners_px.size();
      least_px = std::min(least_px, mean_px.norm());
    }
    EXPECT_LT(least_px, 0.01) << k1;
  }
}

TEST(CirclePerspective, OfAFewPointsStaysAsItIs) {
  const std::vector<Eigen::Vector2d> three = {{0, 0}, {1, 0}, {0, 1}};
  EXPECT_EQ(CentresFrom(three, 0.2, three, {640, 480}), three);
}

}  // namespace
}  // namespace rigcal::detect
