// Checkerboards whose blur is put in: the wave of squares with a Gaussian is a row of error functions, in x and in y.
#include "client/check/edge_width.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rigcal::check {
namespace {

constexpr double kTenToNinety = 2.563;  // of a Gaussian, in sigmas

struct Blur {
  double x_px = 1.0, y_px = 1.0;
};

// Squares of `square_px` from -1 to 1, edges at first_px + k square_px.
double Wave(double at_px, double first_px, double square_px, double sigma_px) {
  double value = -1;
  for (int k = 0; k < 12; ++k) {
    const double sign = k % 2 == 0 ? 1 : -1;
    value += sign * (1 + std::erf((at_px - first_px - k * square_px) / (std::sqrt(2.0) * sigma_px)));
  }
  return value;
}

const Target kBoard{TargetId("board"), 5, 4, 0.03, 0.0, ""};

detect::GreyImage Drawn(double square_px, const Blur& blur, double contrast = 90) {
  detect::GreyImage image{320, 240, {}};
  for (int y = 0; y < image.height_px; ++y)
    for (int x = 0; x < image.width_px; ++x)
      image.pixels.push_back(static_cast<std::uint8_t>(
          std::lround(125 + contrast * Wave(x, 50, square_px, blur.x_px) * Wave(y, 40, square_px, blur.y_px))));
  return image;
}

BoardView Seen(double square_px) {
  BoardView view;
  view.found = true;
  view.image_width_px = 320, view.image_height_px = 240;
  for (int row = 0; row < kBoard.rows; ++row)
    for (int col = 0; col < kBoard.cols; ++col) {
      view.corner_idx.push_back(row * kBoard.cols + col);
      view.corners_px.emplace_back(50 + col * square_px, 40 + row * square_px);
    }
  return view;
}

double WidthOf(double square_px, const Blur& blur) {
  return EdgeWidth_px(Drawn(square_px, blur), Seen(square_px), kBoard).value_or(-1);
}

TEST(EdgeWidth, IsThatOfTheBlur) {
  for (const double sigma_px : {0.8, 1.5, 3.0})
    EXPECT_NEAR(WidthOf(40.3, {sigma_px, sigma_px}), kTenToNinety * sigma_px, 0.4 + 0.03 * sigma_px) << sigma_px;
}

TEST(EdgeWidth, MotionToOneSideShows) {
  EXPECT_NEAR(WidthOf(40, {3.0, 0.8}), kTenToNinety * 3.0, 0.6);
  EXPECT_NEAR(WidthOf(40, {0.8, 3.0}), kTenToNinety * 3.0, 0.6);
}

TEST(EdgeWidth, IsNotToldOfWhatIsTooSmallOrTooPale) {
  EXPECT_FALSE(EdgeWidth_px(Drawn(7, {0.8, 0.8}), Seen(7), kBoard));
  EXPECT_FALSE(EdgeWidth_px(Drawn(40, {0.8, 0.8}, 5), Seen(40), kBoard));
  EXPECT_FALSE(EdgeWidth_px(Drawn(40, {0.8, 0.8}), BoardView{}, kBoard));
}

TEST(EdgeWidth, OfAPartOfABoardIsThatOfThePart) {
  BoardView part = Seen(40);
  part.corner_idx.resize(15), part.corners_px.resize(15);
  EXPECT_NEAR(EdgeWidth_px(Drawn(40, {1.5, 1.5}), part, kBoard).value_or(-1), kTenToNinety * 1.5, 0.5);
}

// Discs of a radius of 15 px, drawn by their distance to the nearest centre.
TEST(EdgeWidth, OfCirclesIsThatOfTheirRims) {
  constexpr double kSpacing_px = 48, kRadius_px = 15;
  Target circles{TargetId("board"), 5, 4, 0.03, 0.0, ""};
  circles.kind = TargetKind::kCircleGrid;
  circles.diameter_m = 2 * kRadius_px / kSpacing_px * circles.square_m;
  for (const double sigma_px : {0.8, 1.5, 3.0}) {
    detect::GreyImage image{320, 240, {}};
    for (int y = 0; y < image.height_px; ++y)
      for (int x = 0; x < image.width_px; ++x) {
        const double to_x = x - 50 - kSpacing_px * std::round((x - 50) / kSpacing_px);
        const double to_y = y - 40 - kSpacing_px * std::round((y - 40) / kSpacing_px);
        const double rim = std::erf((std::hypot(to_x, to_y) - kRadius_px) / (std::sqrt(2.0) * sigma_px));
        image.pixels.push_back(static_cast<std::uint8_t>(std::lround(125 + 90 * rim)));
      }
    EXPECT_NEAR(EdgeWidth_px(image, Seen(kSpacing_px), circles).value_or(-1), kTenToNinety * sigma_px,
                0.5 + 0.03 * sigma_px)
        << sigma_px;
  }
}

TEST(BlurredFrom, IsTheLesserOfWhatHarmsAndWhatStandsOut) {
  EXPECT_NEAR(BlurredFrom_px(640, 1.5), 4.0, 1e-9);
  EXPECT_NEAR(BlurredFrom_px(640, 2.5), 5.0, 1e-9);
  EXPECT_NEAR(BlurredFrom_px(640, 5.0), 6.0, 1e-9);
  EXPECT_NEAR(BlurredFrom_px(4000, 9.0), 10.0, 1e-9);
}

}  // namespace
}  // namespace rigcal::check
