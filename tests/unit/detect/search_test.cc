#include <gtest/gtest.h>

#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

#include "server/detect/checkerboard/board_search.h"
#include "server/detect/checkerboard/corner_refine.h"
#include "server/detect/checkerboard/corners.h"
#include "server/detect/checkerboard/part_search.h"
#include "server/detect/checkerboard/saddle_points.h"
#include "tests/unit/detect/rendering.h"

namespace rigcal::detect {
namespace {

constexpr double kSquare_m = 0.03;

GreyImage ImageOf(const cv::Mat& picture) {
  GreyImage image{picture.cols, picture.rows, {}};
  for (int y = 0; y < picture.rows; ++y)
    image.pixels.insert(image.pixels.end(), picture.ptr(y), picture.ptr(y) + picture.cols);
  return image;
}

Target Board(int cols, int rows) { return {TargetId("board"), cols, rows, kSquare_m, 0, ""}; }

// The board in the middle of the picture, `square_px` a square.
Scene SceneOf(int cols, int rows, double square_px, double roll_rad, double tilt_rad = 0.3) {
  Scene scene = Looking(Eigen::Vector2d(cols - 1, rows - 1) * kSquare_m / 2, 600 * kSquare_m / square_px, roll_rad,
                        tilt_rad, -tilt_rad / 2);
  scene.width_px = 803, scene.height_px = 601;
  return scene;
}

cv::Mat Photo(int cols, int rows, double square_px, double roll_rad, double tilt_rad = 0.3) {
  return Photographed(SceneOf(cols, rows, square_px, roll_rad, tilt_rad), Checkerboard(cols, rows, kSquare_m));
}

double LargestError_px(const Scene& scene, const BoardView& view, int cols) {
  double largest = 0;
  for (std::size_t i = 0; i < view.corners_px.size(); ++i) {
    const int idx = static_cast<int>(i);
    const Eigen::Vector2d truth = scene.Pixel(Eigen::Vector2d(idx % cols, idx / cols) * kSquare_m);
    largest = std::max(largest, (view.corners_px[i] - truth).norm());
  }
  return largest;
}

TEST(SearchBoard, FindsSmallAndLargeSquaresTilted) {
  for (const double square_px : {11.0, 16.0, 28.0, 50.0})
    for (const double tilt_rad : {0.0, 0.5, 0.9}) {
      const Scene scene = SceneOf(9, 6, square_px, 0.7, tilt_rad);
      const cv::Mat picture = Photographed(scene, Checkerboard(9, 6, kSquare_m));
      EXPECT_EQ(SearchBoard(ImageOf(picture), 9, 6).corners_px.size(), 54u) << square_px << " px, " << tilt_rad;
      const AnnotatedView result = DetectIn(picture, Board(9, 6));
      ASSERT_TRUE(result.view.found) << square_px << " px, " << tilt_rad << ": " << result.view.why_not;
      EXPECT_LT(LargestError_px(scene, result.view, 9), 0.4) << square_px << " px, " << tilt_rad;
    }
}

TEST(SearchBoard, CornersStartNearWhereTheyAreRefinedTo) {
  const GreyImage image = ImageOf(Photo(9, 6, 40, 0.4));
  const auto start = SearchBoard(image, 9, 6).corners_px;
  ASSERT_EQ(start.size(), 54u);
  const auto refined = RefinedCorners(image, 9, 6, start);
  for (std::size_t i = 0; i < start.size(); ++i) EXPECT_LT((start[i] - refined[i]).norm(), 1.0) << i;
}

// Against OpenCV's refinement of the same window on the picture as it is.
TEST(RefinedCorners, ScatterLessThanWithoutSmoothing) {
  const Scene scene = SceneOf(9, 6, 40, 0.4);
  const cv::Mat clean = Photo(9, 6, 40, 0.4);
  cv::RNG random(3);
  double smoothed_px2 = 0, plain_px2 = 0;
  for (int draw = 0; draw < 4; ++draw) {
    cv::Mat noise(clean.size(), CV_16S), picture;
    random.fill(noise, cv::RNG::NORMAL, 0, 12);
    cv::add(clean, noise, picture, cv::noArray(), CV_8U);
    std::vector<Eigen::Vector2d> truth;
    std::vector<cv::Point2f> plain;
    for (int i = 0; i < 54; ++i) {
      truth.push_back(scene.Pixel(Eigen::Vector2d(i % 9, i / 9) * kSquare_m));
      plain.emplace_back(static_cast<float>(truth.back().x()), static_cast<float>(truth.back().y()));
    }
    const auto refined = RefinedCorners(ImageOf(picture), 9, 6, truth);
    cv::cornerSubPix(picture, plain, {10, 10}, {-1, -1}, {cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 100, 1e-4});
    for (std::size_t i = 0; i < 54; ++i) {
      smoothed_px2 += (refined[i] - truth[i]).squaredNorm();
      plain_px2 += (Eigen::Vector2d(plain[i].x, plain[i].y) - truth[i]).squaredNorm();
    }
  }
  EXPECT_LT(std::sqrt(smoothed_px2 / (2 * 4 * 54)), 0.1);
  EXPECT_LT(smoothed_px2, 0.85 * plain_px2);
}

TEST(RefinedCorners, StayWhereThePictureEnds) {
  const GreyImage image = ImageOf(Photo(9, 6, 40, 0.4));
  for (const Eigen::Vector2d& start : {Eigen::Vector2d(-60, 20), {-3, -3}, {1e12, 5}, {803, 601}, {NAN, 1}})
    EXPECT_TRUE(EdgesMeet(image, start, 10) == start || start.hasNaN());
  const GreyImage tiny{5, 5, std::vector<std::uint8_t>(25, 100)};
  EXPECT_EQ(EdgesMeet(tiny, {2, 2}, 10), Eigen::Vector2d(2, 2));
}

TEST(SearchBoard, LowContrastWillDo) {
  cv::Mat picture = Photo(9, 6, 30, 1.2);
  picture.convertTo(picture, CV_8U, 0.12, 100);  // 22 grey levels between dark and light
  EXPECT_EQ(SearchBoard(ImageOf(picture), 9, 6).corners_px.size(), 54u);
}

// Any part of a board with other counts would be wrong by whole squares.
TEST(SearchBoard, OtherCountsAreOtherBoards) {
  for (const auto& [cols, rows] : {std::pair{10, 6}, {9, 7}, {10, 7}, {12, 9}, {8, 6}, {9, 5}, {8, 5}, {6, 6}}) {
    const cv::Mat picture = Photo(cols, rows, 26, 0.5);
    EXPECT_TRUE(SearchBoard(ImageOf(picture), 9, 6).corners_px.empty()) << cols << " x " << rows;
    EXPECT_FALSE(DetectIn(picture, Board(9, 6)).view.found) << cols << " x " << rows;
  }
}

TEST(SearchBoard, EachOfTwoBoardsIsFoundByItsCounts) {
  cv::Mat both;
  cv::hconcat(Photo(9, 6, 24, 0.5), Photo(7, 5, 24, -0.8), both);
  const GreyImage image = ImageOf(both);
  const auto left = SearchBoard(image, 9, 6).corners_px, right = SearchBoard(image, 7, 5).corners_px;
  ASSERT_EQ(left.size(), 54u);
  ASSERT_EQ(right.size(), 35u);
  for (const Eigen::Vector2d& corner : left) EXPECT_LT(corner.x(), 803);
  for (const Eigen::Vector2d& corner : right) EXPECT_GT(corner.x(), 803);
}

TEST(SearchBoard, ACutOffBoardIsNone) {
  const cv::Mat whole = Photo(9, 6, 40, 0.02, 0.05);
  for (const int cut_px : {290, 330, 400}) {
    const cv::Mat part = whole.colRange(cut_px, whole.cols).clone();
    EXPECT_TRUE(SearchBoard(ImageOf(part), 9, 6).corners_px.empty()) << cut_px;
    EXPECT_FALSE(DetectIn(part, Board(9, 6)).view.found) << cut_px;
  }
}

// A finger over one corner: a part of the board is known to be there, and it says how large its squares are.
TEST(SearchBoard, ACoveredCornerLeavesAPart) {
  const Scene scene = SceneOf(9, 6, 30, 0.4);
  const auto pattern = Covered(Checkerboard(9, 6, kSquare_m), Eigen::Vector2d(4, 2) * kSquare_m, 0.8 * kSquare_m);
  const BoardSearch search = SearchBoard(ImageOf(Photographed(scene, pattern)), 9, 6);
  EXPECT_TRUE(search.corners_px.empty());
  ASSERT_FALSE(search.parts.empty());
  EXPECT_GE(search.parts.front().corners, 45u);
  EXPECT_NEAR(search.parts.front().square_px, 29, 3);
}

TEST(SearchAround, FindsTheWholeBoardButNoPieceOfALargerOne) {
  const cv::Mat picture = Photo(9, 6, 30, 0.2);
  const std::vector<Eigen::Vector2d> whole = SearchBoard(ImageOf(picture), 9, 6).corners_px;
  ASSERT_EQ(whole.size(), 54u);
  GridPart part{whole[10], whole[10], 30, 24};  // columns 1 to 6 of rows 1 to 4
  for (int row = 1; row <= 4; ++row)
    for (int col = 1; col <= 6; ++col) {
      const Eigen::Vector2d& corner = whole[static_cast<std::size_t>(row * 9 + col)];
      part.min_px = part.min_px.cwiseMin(corner), part.max_px = part.max_px.cwiseMax(corner);
    }
  EXPECT_EQ(SearchAround(picture, part, {9, 6}).size(), 54u);
  EXPECT_TRUE(SearchAround(picture, part, {8, 6}).empty());
  EXPECT_TRUE(SearchAround(picture, part, {6, 4}).empty());
  EXPECT_TRUE(SearchAround(picture, part, {4, 3}).empty());
}

TEST(SearchBoard, NeitherThreadsNorTheMemorysPlaceMatter) {
  const GreyImage image = ImageOf(Photo(9, 6, 18, 2.1));
  const int before = cv::getNumThreads();
  cv::setNumThreads(1);
  const auto one = FindCorners(image, 9, 6);
  cv::setNumThreads(4);
  std::vector<GreyImage> copies(5, image);  // at other addresses
  for (const GreyImage& copy : copies) EXPECT_EQ(one, FindCorners(copy, 9, 6));
  cv::setNumThreads(before);
  ASSERT_TRUE(one.has_value());
}

TEST(SearchBoard, TinyAndEmptyPicturesHaveNone) {
  for (const cv::Size& size : {cv::Size(1, 1), {1, 50}, {7, 3}, {20, 20}, {200, 2}})
    for (const int grey : {0, 255}) {
      const BoardSearch search = SearchBoard(ImageOf(cv::Mat(size, CV_8U, cv::Scalar(grey))), 9, 6);
      EXPECT_TRUE(search.corners_px.empty());
      EXPECT_TRUE(search.parts.empty());
    }
}

TEST(SaddlePoints, AreWhereSquaresMeet) {
  cv::Mat picture(64, 64, CV_8U, cv::Scalar(40));  // dark but for two quarters that meet at 29.5, 35.5
  picture(cv::Rect(30, 0, 34, 36)).setTo(200);
  picture(cv::Rect(0, 36, 30, 28)).setTo(200);
  const auto saddles = SaddlePoints(LevelOf(ImageOf(picture)));
  ASSERT_EQ(saddles.size(), 1u);
  EXPECT_NEAR(saddles[0].at_px.x(), 29.5, 0.3);
  EXPECT_NEAR(saddles[0].at_px.y(), 35.5, 0.3);
  EXPECT_NEAR(saddles[0].contrast, 160, 40);
  // From dark to light, turning clockwise: over the edges up and down.
  EXPECT_GT(std::abs(saddles[0].ways[0].y()), 0.99);
  EXPECT_GT(std::abs(saddles[0].ways[1].x()), 0.99);
}

// Edges, lines, crossing lines and corners of one square are none.
TEST(SaddlePoints, OtherShapesAreNone) {
  cv::Mat picture(256, 256, CV_8U, cv::Scalar(60));
  cv::rectangle(picture, {20, 20}, {90, 90}, cv::Scalar(200), -1);
  cv::line(picture, {110, 10}, {250, 60}, cv::Scalar(220), 3);
  cv::line(picture, {180, 120}, {180, 240}, cv::Scalar(220), 3);
  cv::line(picture, {120, 180}, {240, 180}, cv::Scalar(220), 3);
  cv::circle(picture, {60, 180}, 30, cv::Scalar(150), -1);
  for (const Saddle& saddle : SaddlePoints(LevelOf(ImageOf(picture))))
    ADD_FAILURE() << saddle.at_px.transpose() << ", contrast " << saddle.contrast;
}

// Pixels that are filtered side by side and those at the end of a row give the same numbers.
TEST(SaddlePoints, MoveWithThePicture) {
  const cv::Mat whole = Photo(9, 6, 20, 0.9);
  const auto all = SaddlePoints(LevelOf(ImageOf(whole)));
  for (const int shift : {1, 3, 5, 6}) {
    const auto moved = SaddlePoints(LevelOf(ImageOf(whole.colRange(shift, whole.cols - 2))));
    std::size_t same = 0;
    for (const Saddle& saddle : all)
      for (const Saddle& other : moved)
        same += other.at_px.y() == saddle.at_px.y() && other.contrast == saddle.contrast &&
                        std::abs(other.at_px.x() + static_cast<float>(shift) - saddle.at_px.x()) < 1e-3
                    ? 1
                    : 0;
    EXPECT_GE(same, 54u) << shift;
  }
}

}  // namespace
}  // namespace rigcal::detect
