#include "client/moments/picture_watcher.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rigcal::moments {
namespace {

constexpr int kWidth_px = 400, kHeight_px = 300;
constexpr double kSquare_px = 24;
constexpr std::int64_t kPeriod_ns = 33'000'000;

Target Board() {
  Target board;
  board.id = TargetId("board");
  board.cols = 9, board.rows = 6;
  board.square_m = 0.03;
  return board;
}

struct Drawing {
  double x_px = 60, y_px = 50;  // of the pattern's outer corner
  double dark = 30, light = 220, soft_px = 1.0;
  bool has_board = true;
};

// Of a coordinate in squares: from -1 to 1 with soft edges.
double Wave(double at, double soft) {
  const double within = at - std::floor(at);
  const double edge = std::min(within, 1 - within) / soft;
  return (static_cast<long>(std::floor(at)) % 2 == 0 ? 1 : -1) * std::min(1.0, edge);
}

detect::GreyImage Draw(const Drawing& drawing) {
  detect::GreyImage image{kWidth_px, kHeight_px, {}};
  for (int y = 0; y < kHeight_px; ++y)
    for (int x = 0; x < kWidth_px; ++x) {
      const double u = (x - drawing.x_px) / kSquare_px, v = (y - drawing.y_px) / kSquare_px;
      const bool inside = drawing.has_board && u > 0 && v > 0 && u < 10 && v < 7;
      const double wave = inside ? -Wave(u, drawing.soft_px / kSquare_px) * Wave(v, drawing.soft_px / kSquare_px) : 1;
      image.pixels.push_back(
          static_cast<std::uint8_t>(std::lround(drawing.dark + (drawing.light - drawing.dark) * (wave + 1) / 2)));
    }
  return image;
}

TEST(PictureWatcher, FollowsABoardAndTellsHowFarItMoved) {
  const Target board = Board();
  PictureWatcher watcher({&board});
  const Sight first = watcher.Look(Draw({}), 0);
  ASSERT_TRUE(first.found());
  EXPECT_NEAR(first.m_per_px, 0.03 / kSquare_px, 2e-5);
  EXPECT_LE(first.corner_idx.size(), kCornersKept);
  Drawing moved;
  for (int k = 1; k < 60; ++k) {
    moved.x_px = 60 + 0.9 * k, moved.y_px = 50 + 0.4 * k;
    const Sight sight = watcher.Look(Draw(moved), k * kPeriod_ns);
    ASSERT_TRUE(sight.found()) << k;
    const auto shift = ShiftBetween(first, sight);
    ASSERT_TRUE(shift);
    EXPECT_NEAR(shift->px, k * std::hypot(0.9, 0.4), 0.1) << k;
  }
}

TEST(PictureWatcher, ABoardThatStandsStillMovesByLittle) {
  const Target board = Board();
  PictureWatcher watcher({&board});
  const Sight first = watcher.Look(Draw({}), 0);
  for (int k = 1; k < 40; ++k) {
    const auto shift = ShiftBetween(first, watcher.Look(Draw({}), k * kPeriod_ns));
    ASSERT_TRUE(shift);
    EXPECT_LT(shift->px, 0.05) << k;
  }
}

TEST(PictureWatcher, ABoardThatGoesAwayIsNotInView) {
  const Target board = Board();
  PictureWatcher watcher({&board});
  ASSERT_TRUE(watcher.Look(Draw({}), 0).found());
  Drawing none;
  none.has_board = false;
  for (int k = 1; k < 10; ++k) EXPECT_FALSE(watcher.Look(Draw(none), k * kPeriod_ns).found()) << k;
  bool came_back = false;
  for (int k = 10; k < 20; ++k) came_back = watcher.Look(Draw({}), k * kPeriod_ns).found() || came_back;
  EXPECT_TRUE(came_back);
}

TEST(PictureWatcher, EdgesLightAndContrastAreThoseOfTheBoard) {
  const Target board = Board();
  Drawing glaring, dim;
  glaring.light = 255;
  dim.dark = 10, dim.light = 45;
  const Sight usual = PictureWatcher({&board}).Look(Draw({}), 0);
  ASSERT_TRUE(usual.edge_px);
  EXPECT_LT(*usual.edge_px, 3.0);
  EXPECT_EQ(usual.bright_ratio, 0.0);
  EXPECT_GT(usual.contrast_grey, 100.0);
  EXPECT_GT(PictureWatcher({&board}).Look(Draw(glaring), 0).bright_ratio, 0.25);
  const Sight dark = PictureWatcher({&board}).Look(Draw(dim), 0);
  EXPECT_TRUE(!dark.found() || dark.contrast_grey < 40.0);
}

}  // namespace
}  // namespace rigcal::moments
