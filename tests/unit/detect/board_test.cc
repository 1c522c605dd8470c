#include "server/detect/board.h"

#include <gmock/gmock.h>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace rigcal::detect {
namespace {

using testing::HasSubstr;
using Corners = std::vector<Eigen::Vector2d>;

const Target kBoard{TargetId("board"), 9, 6, 0.025, 0.0, ""};

constexpr int kSquarePx = 160;  // of the drawn board, which is then photographed four times smaller

// The board from the front, with a light margin: the first inner square is dark.
cv::Mat Drawn() {
  cv::Mat drawn((kBoard.rows + 3) * kSquarePx, (kBoard.cols + 3) * kSquarePx, CV_8U, cv::Scalar(225));
  for (int row = -1; row < kBoard.rows; ++row)
    for (int col = -1; col < kBoard.cols; ++col)
      if ((row + col) % 2 == 0)
        cv::rectangle(drawn, cv::Rect((col + 2) * kSquarePx, (row + 2) * kSquarePx, kSquarePx, kSquarePx),
                      cv::Scalar(30), -1);
  return drawn;
}

struct Photo {
  cv::Mat grey;
  Corners corners_px;  // truth
};

// Through a homography from drawn pixels to picture pixels, area-sampled.
Photo Photographed(double turn_rad, double tilt, int width_px = 640, int height_px = 480) {
  constexpr int kOversampling = 4;
  const double c = std::cos(turn_rad), s = std::sin(turn_rad), scale = 0.2 * width_px / 640.0;
  const cv::Matx33d centre(1, 0, -0.5 * 12 * kSquarePx, 0, 1, -0.5 * 9 * kSquarePx, 0, 0, 1);
  const cv::Matx33d view(scale * c, -scale * s, 0, scale * s, scale * c, 0, tilt / 4000, -tilt / 6000, 1);
  const cv::Matx33d place(1, 0, 0.5 * width_px, 0, 1, 0.5 * height_px, 0, 0, 1);
  const cv::Matx33d H = place * view * centre;
  const double half = 0.5 * (kOversampling - 1);
  const cv::Matx33d enlarge(kOversampling, 0, half, 0, kOversampling, half, 0, 0, 1);
  cv::Mat large, grey;
  cv::warpPerspective(Drawn(), large, enlarge * H, {width_px * kOversampling, height_px * kOversampling},
                      cv::INTER_AREA, cv::BORDER_CONSTANT, cv::Scalar(225));
  cv::resize(large, grey, {width_px, height_px}, 0, 0, cv::INTER_AREA);
  Photo photo{grey, {}};
  for (int row = 0; row < kBoard.rows; ++row)
    for (int col = 0; col < kBoard.cols; ++col) {
      // Squares meet half a pixel before the first pixel of the next one.
      const cv::Vec3d point = H * cv::Vec3d((col + 2) * kSquarePx - 0.5, (row + 2) * kSquarePx - 0.5, 1);
      photo.corners_px.emplace_back(point[0] / point[2], point[1] / point[2]);
    }
  return photo;
}

std::string Encoded(const cv::Mat& picture, const std::string& suffix = ".png") {
  std::vector<std::uint8_t> bytes;
  cv::imencode(suffix, picture, bytes);
  return {bytes.begin(), bytes.end()};
}

AnnotatedView DetectIn(const std::string& bytes, const Target& board = kBoard) {
  return Detect(std::as_bytes(std::span(bytes)), board);
}

double LargestError_px(const Corners& found, const Corners& truth) {
  if (found.size() != truth.size()) return HUGE_VAL;
  double largest = 0;
  for (std::size_t i = 0; i < found.size(); ++i) largest = std::max(largest, (found[i] - truth[i]).norm());
  return largest;
}

// In every turn of the board the same physical corner comes first.
TEST(Detect, FindsTheTrueCornersInTheirOrderHoweverTheBoardIsTurned) {
  for (int step = 0; step < 12; ++step) {
    const Photo photo = Photographed(step * M_PI / 6 + 0.1, 0.6);
    const AnnotatedView result = DetectIn(Encoded(photo.grey));
    ASSERT_TRUE(result.view.found) << step << ": " << result.view.why_not;
    EXPECT_LT(LargestError_px(result.view.corners_px, photo.corners_px), 0.15) << step;
    EXPECT_EQ(result.view.image_width_px, 640);
    EXPECT_EQ(result.view.image_height_px, 480);
    EXPECT_EQ(result.view.target, kBoard.id);
  }
}

TEST(Detect, CountsTheOtherWayRoundGiveTheOtherOrder) {
  Target tall = kBoard;
  std::swap(tall.cols, tall.rows);
  const AnnotatedView result = DetectIn(Encoded(Photographed(0.3, 0.4).grey), tall);
  ASSERT_TRUE(result.view.found) << result.view.why_not;
  const Corners& corners = result.view.corners_px;
  const Eigen::Vector2d along = corners[1] - corners[0], down = corners[6] - corners[0];
  EXPECT_GT(along.x() * down.y() - along.y() * down.x(), 0);
}

// A reflection in a mirror has its colours in the mirrored order: what comes out is right-handed in the picture even
// so.
TEST(Detect, NeverGivesAMirroredOrder) {
  cv::Mat mirrored;
  cv::flip(Photographed(0.4, 0.5).grey, mirrored, 1);
  const AnnotatedView result = DetectIn(Encoded(mirrored));
  ASSERT_TRUE(result.view.found) << result.view.why_not;
  const Corners& corners = result.view.corners_px;
  const Eigen::Vector2d along = corners[1] - corners[0], down = corners[9] - corners[0];
  EXPECT_GT(along.x() * down.y() - along.y() * down.x(), 0);
}

TEST(Detect, ReadsEveryKindOfPicture) {
  const Photo photo = Photographed(0.2, 0.5);
  cv::Mat colour, deep, deep_colour;
  cv::cvtColor(photo.grey, colour, cv::COLOR_GRAY2BGR);
  photo.grey.convertTo(deep, CV_16U, 16);  // 12 bit in the lower part of the range
  deep.at<std::uint16_t>(5, 5) = 65535;    // and a hot pixel
  colour.convertTo(deep_colour, CV_16U, 257);
  for (const std::string& bytes :
       {Encoded(photo.grey, ".jpg"), Encoded(colour), Encoded(colour, ".jpg"), Encoded(deep), Encoded(deep_colour)}) {
    const AnnotatedView result = DetectIn(bytes);
    ASSERT_TRUE(result.view.found) << result.view.why_not;
    EXPECT_LT(LargestError_px(result.view.corners_px, photo.corners_px), 0.2);
  }
}

TEST(Detect, FindsTheBoardInLargePictures) {
  const Photo photo = Photographed(0.2, 0.5, 2560, 1920);
  const AnnotatedView result = DetectIn(Encoded(photo.grey));
  ASSERT_TRUE(result.view.found) << result.view.why_not;
  EXPECT_LT(LargestError_px(result.view.corners_px, photo.corners_px), 0.2);
}

TEST(Detect, SaysWhyNot) {
  EXPECT_THAT(DetectIn("").view.why_not, HasSubstr("neither PNG nor JPEG"));
  std::string broken = Encoded(Photographed(0.2, 0.5).grey);
  broken.resize(60);
  EXPECT_THAT(DetectIn(broken).view.why_not, HasSubstr("the picture cannot be decoded"));
  EXPECT_TRUE(DetectIn(broken).picture.empty());
  const AnnotatedView bare = DetectIn(Encoded(cv::Mat(480, 640, CV_8U, cv::Scalar(90))));
  EXPECT_THAT(bare.view.why_not, HasSubstr("no 9 x 6 board in the picture"));
  EXPECT_TRUE(bare.view.corners_px.empty());
  EXPECT_FALSE(bare.picture.empty());
}

TEST(Detect, RefusesBoardsThatAreTooSmall) {
  Target board = kBoard;
  board.rows = 2;
  EXPECT_THAT(DetectIn(Encoded(Photographed(0.2, 0.5).grey), board).view.why_not, HasSubstr("3 to 256"));
}

TEST(Detect, ADecodedPictureGivesTheSameView) {
  for (const std::string& bytes : {Encoded(Photographed(0.7, 0.5).grey), Encoded(cv::Mat(480, 640, CV_8U, 120.0))}) {
    const auto image = DecodeGrey(std::as_bytes(std::span(bytes)));
    ASSERT_TRUE(image) << image.error().what;
    EXPECT_EQ(FindIn(*image, kBoard), DetectIn(bytes).view);
  }
  Target small = kBoard;
  small.rows = 2;
  const BoardView refused = FindIn({4, 3, std::vector<std::uint8_t>(12)}, small);
  EXPECT_THAT(refused.why_not, HasSubstr("3 to 256"));
  EXPECT_EQ(refused.image_width_px, 4);
}

TEST(Detect, TheThreadCountDoesNotMatter) {
  const std::string bytes = Encoded(Photographed(0.7, 0.5).grey);
  const int before = cv::getNumThreads();
  cv::setNumThreads(1);
  const AnnotatedView one = DetectIn(bytes);
  cv::setNumThreads(4);
  const AnnotatedView four = DetectIn(bytes);
  cv::setNumThreads(before);
  ASSERT_TRUE(one.view.found);
  EXPECT_EQ(one.view.corners_px, four.view.corners_px);
  EXPECT_EQ(one.picture, four.picture);
}

TEST(Detect, ThePictureOfALargeOneIsNotWiderThan1280) {
  const AnnotatedView result = DetectIn(Encoded(Photographed(0.2, 0.5, 2560, 1920).grey));
  const cv::Mat picture =
      cv::imdecode(std::vector<char>(result.picture.begin(), result.picture.end()), cv::IMREAD_COLOR);
  EXPECT_EQ(picture.cols, 1280);
  EXPECT_EQ(picture.rows, 960);
}

TEST(DetectorKey, TellsGeometriesApart) {
  Target other = kBoard;
  other.cols = 7;
  EXPECT_NE(DetectorKey(kBoard), DetectorKey(other));
  other = kBoard;
  other.id = TargetId("other");
  EXPECT_NE(DetectorKey(kBoard), DetectorKey(other));
  other = kBoard;
  other.square_m = 0.05;  // corners in the picture do not depend on it
  EXPECT_EQ(DetectorKey(kBoard), DetectorKey(other));
}

}  // namespace
}  // namespace rigcal::detect
