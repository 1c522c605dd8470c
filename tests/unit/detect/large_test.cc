// Marker boards in pictures so large that a glance comes before the search.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <random>

#include "server/detect/markers/marker_code.h"
#include "tests/unit/detect/rendering.h"

namespace rigcal::detect {
namespace {

using testing::HasSubstr;

cv::Mat InALargePicture(const cv::Mat& picture) {
  cv::Mat large;
  cv::copyMakeBorder(picture, large, 0, 0, 0, 2600 - picture.cols, cv::BORDER_CONSTANT, cv::Scalar(kBackground));
  return large;
}

TEST(DetectInLargePictures, FindsCharucoBoardsFromBothSides) {
  const Charuco board;
  for (const double behind_rad : {0.0, M_PI}) {
    const Scene scene = Looking({0.06, 0.1}, 0.5, 0.3, 0.2 + behind_rad, 0.1);
    const AnnotatedView found = DetectIn(InALargePicture(Photographed(scene, Drawn(board))), TargetOf(board));
    ASSERT_TRUE(found.view.found) << found.view.why_not;
    EXPECT_EQ(found.view.corner_idx.size(), 24u);
    EXPECT_LT(ErrorsOf(found.view, Truth(scene, board)).rms_px, 0.2);
  }
}

TEST(DetectInLargePictures, FindsTagsWithBothBordersAndTouchingSquares) {
  for (const int border_bits : {1, 2}) {
    TagGrid grid;
    grid.cols = grid.rows = 4, grid.border_bits = border_bits;
    const Scene scene = Looking({0.07, 0.07}, 0.4, 0.2, 0.3);
    const AnnotatedView found = DetectIn(InALargePicture(Photographed(scene, Drawn(grid))), TargetOf(grid));
    ASSERT_TRUE(found.view.found) << found.view.why_not;
    EXPECT_GT(found.view.corner_idx.size(), 48u);
    EXPECT_LT(ErrorsOf(found.view, Truth(scene, grid)).rms_px, 0.2);
  }
}

TEST(DetectInLargePictures, SaysThatThereIsNone) {
  const cv::Mat empty(600, 2600, CV_8U, cv::Scalar(kBackground));
  EXPECT_THAT(DetectIn(empty, TargetOf(Charuco())).view.why_not, HasSubstr("no marker of DICT_4X4_50 was read"));
  EXPECT_THAT(DetectIn(empty, TargetOf(TagGrid())).view.why_not, HasSubstr("no tag of DICT_APRILTAG_36h11 was read"));
}

// Codes of the dictionary with more and more wrong bits, in all turns, and any others.
TEST(DetectInLargePictures, TheTableKnowsTheCodesThatOpenCvKnows) {
  std::mt19937_64 random(3);
  for (const char* name : {"DICT_4X4_50", "DICT_7X7_1000", "DICT_ARUCO_ORIGINAL", "DICT_APRILTAG_36h11"}) {
    const auto dictionary = DictionaryOf(name);
    const CodeTable table = TableOf(*dictionary);
    int known = 0, unknown = 0;
    for (int i = 0; i < 300; ++i) {
      const int row = static_cast<int>(random() % static_cast<std::uint64_t>(dictionary->bytesList.rows));
      cv::Mat bits = cv::aruco::Dictionary::getBitsFromByteList(dictionary->bytesList.row(row), dictionary->markerSize);
      for (int wrong = 0; wrong < i % 9; ++wrong) bits.at<std::uint8_t>(static_cast<int>(random() % bits.total())) ^= 1;
      if (i % 4 > 0) cv::rotate(bits.clone(), bits, i % 4 - 1);
      int id = -1, turns = 0;
      const bool identified = dictionary->identify(bits, id, turns, 0.6);
      EXPECT_EQ(table.IdOf(PackedBits(bits)), identified ? std::optional(id) : std::nullopt) << name << " " << i;
      ++(identified ? known : unknown);
    }
    EXPECT_GT(known, 30) << name;
    EXPECT_GT(unknown, 30) << name;
  }
}

TEST(DetectInLargePictures, TellsTheMarkersOfOtherBoards) {
  Charuco board;
  board.squares_x = board.squares_y = 8, board.square_m = 0.03, board.marker_m = 0.022;
  const cv::Mat picture = InALargePicture(Photographed(Looking({0.06, 0.06}, 0.3, 0.2), Drawn(board)));
  Charuco asked;
  asked.squares_x = 3, asked.squares_y = 4;
  EXPECT_THAT(DetectIn(picture, TargetOf(asked)).view.why_not, HasSubstr("not placed as on it"));
}

}  // namespace
}  // namespace rigcal::detect
