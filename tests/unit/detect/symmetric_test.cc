#include <gmock/gmock.h>

#include "tests/unit/detect/rendering.h"

namespace rigcal::detect {
namespace {

constexpr double kSquare_m = 0.03;

Target Board(int cols, int rows) { return {TargetId("board"), cols, rows, kSquare_m, 0, ""}; }

Scene SceneOf(int cols, int rows, double roll_rad) {
  return Looking(Eigen::Vector2d(cols - 1, rows - 1) * kSquare_m / 2, 0.5, roll_rad, 0.4, -0.2);
}

// True pixels of the corners as indexed when the board is taken as turned; quarter turns need equal counts.
std::vector<Eigen::Vector2d> Turned(const Scene& scene, int cols, int rows, int quarters) {
  std::vector<Eigen::Vector2d> pixels;
  for (int row = 0; row < rows; ++row)
    for (int col = 0; col < cols; ++col) {
      Eigen::Vector2d at(col, row);
      if (quarters == 1) at = {row, cols - 1 - col};
      if (quarters == 2) at = {cols - 1 - col, rows - 1 - row};
      if (quarters == 3) at = {rows - 1 - row, col};
      pixels.push_back(scene.Pixel(at * kSquare_m));
    }
  return pixels;
}

double LargestError_px(const std::vector<Eigen::Vector2d>& found, const std::vector<Eigen::Vector2d>& truth) {
  if (found.size() != truth.size()) return HUGE_VAL;
  double largest = 0;
  for (std::size_t i = 0; i < found.size(); ++i) largest = std::max(largest, (found[i] - truth[i]).norm());
  return largest;
}

// Which of the quarter turns the corners found are in; -1: none of those allowed.
int TurnFound(const AnnotatedView& result, const Scene& scene, int cols, int rows, const std::vector<int>& allowed) {
  for (const int quarters : allowed)
    if (LargestError_px(result.view.corners_px, Turned(scene, cols, rows, quarters)) < 0.3) return quarters;
  return -1;
}

void ExpectOneOf(int cols, int rows, bool first_dark, const std::vector<int>& allowed) {
  for (int step = 0; step < 8; ++step) {
    const Scene scene = SceneOf(cols, rows, step * M_PI / 4 + 0.1);
    const AnnotatedView result =
        DetectIn(Photographed(scene, Checkerboard(cols, rows, kSquare_m, first_dark)), Board(cols, rows));
    ASSERT_TRUE(result.view.found) << step << ": " << result.view.why_not;
    EXPECT_GE(TurnFound(result, scene, cols, rows, allowed), 0) << step;
    EXPECT_EQ(result.view.corner_idx.size(), static_cast<std::size_t>(cols * rows));
  }
}

TEST(DetectSymmetric, BothCountsOdd) {
  for (const bool first_dark : {true, false}) ExpectOneOf(7, 5, first_dark, {0, 2});
}

TEST(DetectSymmetric, BothCountsEven) {
  for (const bool first_dark : {true, false}) ExpectOneOf(8, 6, first_dark, {0, 2});
}

TEST(DetectSymmetric, EqualEvenCounts) {
  for (const bool first_dark : {true, false}) ExpectOneOf(6, 6, first_dark, {0, 1, 2, 3});
}

// A quarter turn exchanges the colours: the first inner square is dark in what is found, however it was drawn.
TEST(DetectSymmetric, EqualOddCountsAreSettledByColourToHalfATurn) {
  ExpectOneOf(5, 5, true, {0, 2});
  ExpectOneOf(5, 5, false, {1, 3});
}

TEST(DetectSymmetric, OneOddCountHasOneOrder) {
  ExpectOneOf(7, 6, true, {0});
  ExpectOneOf(7, 6, false, {2});
}

TEST(DetectSymmetric, StartsClosestToThePicturesTopLeft) {
  for (const auto& [cols, rows] : {std::pair{7, 5}, {8, 6}, {6, 6}}) {
    const Scene scene = SceneOf(cols, rows, 2.9);
    const AnnotatedView result = DetectIn(Photographed(scene, Checkerboard(cols, rows, kSquare_m)), Board(cols, rows));
    ASSERT_TRUE(result.view.found) << result.view.why_not;
    EXPECT_LT(result.view.corners_px.front().sum(), result.view.corners_px.back().sum());
  }
}

// The product's own symmetry and the pictures agree: what is found is one of the turns that TurnedIndex() names.
TEST(DetectSymmetric, AgreesWithTheTargetsSymmetry) {
  for (const auto& [cols, rows] : {std::pair{7, 5}, {8, 6}, {6, 6}, {5, 5}}) {
    const Target target = Board(cols, rows);
    const Scene scene = SceneOf(cols, rows, 1.7);
    const AnnotatedView result = DetectIn(Photographed(scene, Checkerboard(cols, rows, kSquare_m)), target);
    ASSERT_TRUE(result.view.found) << result.view.why_not;
    int agreeing = 0;
    for (int turn = 0; turn < SymmetryOf(target); ++turn) {
      double largest_px = 0;
      for (int idx = 0; idx < cols * rows; ++idx) {
        const auto turned = static_cast<std::size_t>(TurnedIndex(target, idx, turn));
        const Eigen::Vector2d truth = scene.Pixel(Eigen::Vector2d(idx % cols, idx / cols) * kSquare_m);
        largest_px = std::max(largest_px, (result.view.corners_px[turned] - truth).norm());
      }
      agreeing += largest_px < 0.3 ? 1 : 0;
    }
    EXPECT_EQ(agreeing, 1) << cols << " x " << rows;
  }
}

}  // namespace
}  // namespace rigcal::detect
