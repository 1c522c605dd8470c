// What is black on a board, against OpenCV's own drawing, against the code that the AprilTag family defines, and by
// counting.
#include "client/print/pattern.h"

#include <gmock/gmock.h>

#include <opencv2/aruco/charuco.hpp>
#include <opencv2/core.hpp>

#include "client/print/marker.h"
#include "client/print/pdf.h"
#include "client/print/sheet.h"
#include "client/print/sheet_words.h"
#include "client/print/svg.h"
#include "server/base/result.h"

namespace rigcal::print {
namespace {

using testing::HasSubstr;

bool IsBlackAt(const Pattern& pattern, double x_m, double y_m) {
  for (const Rectangle& one : pattern.black)
    if (x_m >= one.x_m && x_m < one.x_m + one.width_m && y_m >= one.y_m && y_m < one.y_m + one.height_m) return true;
  return false;
}

Target Charuco(int squares_x, int squares_y) {
  Target target;
  target.id = TargetId("board"), target.kind = TargetKind::kCharuco, target.serial = "B-1";
  target.cols = squares_x - 1, target.rows = squares_y - 1;
  target.square_m = 0.04, target.marker_m = 0.03, target.dictionary = "DICT_5X5_100";
  return target;
}

TEST(PrintedPattern, ACharucoIsOpenCvs) {
  for (const auto& [squares_x, squares_y] : {std::pair(5, 7), std::pair(6, 5), std::pair(7, 4)}) {
    const Target target = Charuco(squares_x, squares_y);
    const Pattern pattern = DrawPattern(target).value();
    const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_5X5_100);
    const auto board = cv::aruco::CharucoBoard::create(squares_x, squares_y, 0.04f, 0.03f, dictionary);
    cv::Mat drawn;  // 28 px a cell of a marker: 7 of them, and a square is 9 1/3 cells
    board->draw(cv::Size(squares_x * 280, squares_y * 280), drawn, 0, 1);
    const bool first_is_white = drawn.at<std::uint8_t>(140, 140) > 127 || drawn.at<std::uint8_t>(10, 10) > 127;
    if (first_is_white && squares_y % 2 == 0) continue;  // drawn as before OpenCV 4.6: another layout
    for (int y = 10; y < drawn.rows; y += 20)
      for (int x = 10; x < drawn.cols; x += 20) {
        const cv::Mat around = drawn(cv::Rect(x - 3, y - 3, 6, 6));
        double least = 0, most = 0;
        cv::minMaxLoc(around, &least, &most);
        if (least != most) continue;  // an edge: rounded to whole pixels there
        ASSERT_EQ(IsBlackAt(pattern, x * 0.04 / 280, y * 0.04 / 280), most < 128) << squares_x << " " << x << " " << y;
      }
  }
}

// The family's first code, row by row from the top left, 1 is white.
TEST(PrintedPattern, AnAprilTagIsDrawnAsItsFamilyHasIt) {
  constexpr std::uint64_t kFirst36h11 = 0xd5d628584;
  const auto markers = MarkersOf(TargetKind::kAprilGrid, "DICT_APRILTAG_36h11", {0}).value();
  ASSERT_EQ(markers.front().cells, 10) << "6 and a border of two";
  std::uint64_t code = 0;
  int border = 0;
  for (int i = 0; i < 100; ++i) {
    const int row = i / 10, col = i % 10;
    const bool is_black = markers.front().is_black[static_cast<std::size_t>(i)];
    if (row < 2 || row > 7 || col < 2 || col > 7)
      border += is_black ? 1 : 0;
    else
      code = code << 1 | (is_black ? 0 : 1);
  }
  EXPECT_EQ(border, 64);
  EXPECT_EQ(code, kFirst36h11);
}

TEST(PrintedPattern, AnAprilGridBeginsAtTheBottomLeftAndHasSquaresInItsGaps) {
  Target target = Charuco(2, 2);
  target.kind = TargetKind::kAprilGrid, target.cols = 3, target.rows = 2, target.square_m = 0.1;
  target.spacing_ratio = 0.3, target.dictionary = "DICT_APRILTAG_36h11";
  const Pattern pattern = DrawPattern(target).value();
  EXPECT_NEAR(pattern.width_m, 3 * 0.13 + 0.03, 1e-12);
  EXPECT_NEAR(pattern.height_m, 2 * 0.13 + 0.03, 1e-12);
  const auto markers = MarkersOf(target.kind, target.dictionary, {0, 1, 2, 3, 4, 5}).value();
  for (int id = 0; id < 6; ++id)
    for (int cell = 0; cell < 100; ++cell) {
      const double x_m = 0.03 + id % 3 * 0.13 + (cell % 10 + 0.5) * 0.01,
                   y_m = 0.03 + (1 - id / 3) * 0.13 + (cell / 10 + 0.5) * 0.01;
      EXPECT_EQ(IsBlackAt(pattern, x_m, y_m),
                markers[static_cast<std::size_t>(id)].is_black[static_cast<std::size_t>(cell)]);
    }
  for (int i = 0; i < 12; ++i) EXPECT_TRUE(IsBlackAt(pattern, i % 4 * 0.13 + 0.015, i / 4 * 0.13 + 0.015)) << i;
  EXPECT_FALSE(IsBlackAt(pattern, 0.08, 0.015)) << "a gap";
}

TEST(PrintedPattern, TooFewMarkersAreSaid) {
  Target target = Charuco(11, 10);
  target.dictionary = "DICT_5X5_50";
  const auto drawn = DrawPattern(target);
  ASSERT_FALSE(drawn);
  EXPECT_EQ(drawn.error().what, "the board needs 55 markers, and DICT_5X5_50 has 50");
}

TEST(Sheet, AutoTakesTheSmallestPaperAndOneOfItsOwnBeyondA0) {
  EXPECT_EQ(LayOut(Charuco(4, 3), "auto")->paper, "A4");
  EXPECT_EQ(LayOut(Charuco(8, 5), "auto")->paper, "A3");
  Target large = Charuco(40, 25);
  large.dictionary = "DICT_5X5_1000";
  const Sheet own = LayOut(large, "auto").value();
  EXPECT_EQ(own.paper, "custom");
  EXPECT_GT(own.width_m, 1.6);
  const auto refused = LayOut(large, "A4");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().what, HasSubstr("does not fit on A4: with rulers and margins it needs 1654 x "));
  EXPECT_THAT(LayOut(Charuco(8, 5), "A4").error().cure, HasSubstr("Use --paper A3"));
  EXPECT_FALSE(LayOut(large, "B5"));
}

TEST(Sheet, WhatIsTooLargeIsToldInItsOwnWords) {
  Target circles;
  circles.id = TargetId("board");
  circles.kind = TargetKind::kCircleGrid;
  circles.cols = 11, circles.rows = 8, circles.square_m = 0.020, circles.diameter_m = 0.010;
  EXPECT_EQ(LayOut(circles, "A4").error().cure,
            "Use --paper A3, or a board of fewer circles, or of circles that are nearer to each other.");
  EXPECT_THAT(LayOut(Charuco(8, 5), "A4").error().cure, testing::EndsWith("a board of fewer or smaller squares."));
}

TEST(Sheet, NothingLiesOnAnythingElseAndAllIsOnThePaper) {
  for (const char* paper : {"A4", "A3", "A0", "letter"}) {
    const Sheet sheet = LayOut(Charuco(4, 3), paper).value();
    for (const Rectangle& one : sheet.black) {
      EXPECT_GE(one.x_m, 0.0099) << paper;
      EXPECT_GE(one.y_m, 0.0098) << paper;
      EXPECT_LE(one.x_m + one.width_m, sheet.width_m - 0.0099) << paper;
      EXPECT_LE(one.y_m + one.height_m, sheet.height_m - 0.0099) << paper;
    }
    EXPECT_GE(sheet.ruler_x_m, 0.1 - 1e-12) << paper;
    EXPECT_GE(sheet.ruler_y_m, 0.1 - 1e-12) << paper;
  }
}

TEST(Sheet, SaysWhatItIsAndWhatToType) {
  const std::string svg = WriteSvg(LayOut(Charuco(4, 3), "A4").value(), "board");
  EXPECT_THAT(svg, HasSubstr("B-1   charuco of 4 x 3 squares, 40 mm, DICT_5X5_100, markers 30 mm"));
  EXPECT_THAT(
      svg,
      HasSubstr(
          "rigcal board measure B-1 --type charuco --cols 4 --rows 3 --square-mm 40 --ruler-x-mm A --ruler-y-mm B"));
  EXPECT_EQ(YamlOf(Charuco(4, 3)),
            "{type: charuco, squares: [4, 3], square_size_m: 0.04, marker_size_m: 0.03, dictionary: DICT_5X5_100, "
            "serial: \"B-1\"}");
}

TEST(Sheet, TheSameSheetIsTheSameFile) {
  const Sheet sheet = LayOut(Charuco(4, 3), "A4").value();
  EXPECT_EQ(WritePdf(sheet, "board").value(), WritePdf(sheet, "board").value());
  EXPECT_EQ(WritePdf(sheet, "board")->find("CreationDate"), std::string::npos);
  EXPECT_EQ(WriteSvg(sheet, "board"), WriteSvg(sheet, "board"));
  Target hostile = Charuco(4, 3);
  hostile.serial = "<script>\"&'";
  EXPECT_EQ(WriteSvg(LayOut(hostile, "A4").value(), hostile.serial).find("<script"), std::string::npos);
}

TEST(PrintedPattern, CirclesHaveTheirTrueSizeAndPlace) {
  Target target;
  target.id = TargetId("board"), target.kind = TargetKind::kAsymmetricCircleGrid, target.serial = "C-1";
  target.cols = 4, target.rows = 11, target.square_m = 0.02, target.diameter_m = 0.014;
  const Pattern pattern = DrawPattern(target).value();
  EXPECT_NEAR(pattern.width_m, 0.154, 1e-12);
  EXPECT_NEAR(pattern.height_m, 0.214, 1e-12);
  EXPECT_TRUE(pattern.black.empty());
  ASSERT_EQ(pattern.discs.size(), 44u);
  EXPECT_NEAR(pattern.discs[4].x_m, 0.027, 1e-12);
  EXPECT_NEAR(pattern.discs[4].y_m, 0.027, 1e-12);
  EXPECT_EQ(YamlOf(target),
            "{type: asymmetric_circle_grid, circles: [4, 11], spacing_m: 0.02, diameter_m: 0.014, serial: \"C-1\"}");
  const Sheet sheet = LayOut(target, "auto").value();
  const std::string svg = WriteSvg(sheet, "board"), row = "\" r=\"7\"/>";
  int circles = 0;
  for (std::size_t at = svg.find(row); at != std::string::npos; at = svg.find(row, at + 1)) ++circles;
  EXPECT_EQ(circles, 44) << "radii in mm";
}

}  // namespace
}  // namespace rigcal::print
