#include <gmock/gmock.h>

#include <opencv2/imgproc.hpp>

#include "tests/unit/detect/rendering.h"

namespace rigcal::detect {
namespace {

using testing::HasSubstr;

const Charuco kBoard;  // 5 x 7 squares of 40 mm
const Eigen::Vector2d kCentre(0.06, 0.1);

TEST(DetectCharuco, FindsTheTrueCornersHoweverTheBoardIsTurned) {
  for (int step = 0; step < 8; ++step) {
    const Scene scene = Looking(kCentre, 0.5, step * M_PI / 4 + 0.1, 0.5, -0.2);
    const AnnotatedView result = DetectIn(Photographed(scene, Drawn(kBoard)), TargetOf(kBoard));
    ASSERT_TRUE(result.view.found) << step << ": " << result.view.why_not;
    EXPECT_EQ(result.view.corner_idx.size(), 24u) << step;
    EXPECT_TRUE(std::is_sorted(result.view.corner_idx.begin(), result.view.corner_idx.end()));
    const Errors errors = ErrorsOf(result.view, Truth(scene, kBoard));
    EXPECT_LT(errors.rms_px, 0.1) << step;
    EXPECT_LT(errors.largest_px, 0.3) << step;
    EXPECT_EQ(result.view.image_width_px, 640);
    EXPECT_EQ(result.view.target, TargetId("board"));
    EXPECT_FALSE(result.picture.empty());
  }
}

// Odd and even rows of squares, in both layouts, dark on light and light on dark.
TEST(DetectCharuco, FindsEveryLayout) {
  for (const int squares_y : {5, 6})
    for (const int squares_x : {4, 5})
      for (const bool legacy : {false, true})
        for (const bool inverted : {false, true}) {
          const Charuco board{squares_x, squares_y, 0.04, 0.03, "DICT_5X5_100", legacy, inverted};
          const Scene scene = Looking({0.02 * (squares_x - 2), 0.02 * (squares_y - 2)}, 0.45, 0.4, 0.3, 0.3);
          const AnnotatedView result = DetectIn(Photographed(scene, Drawn(board)), TargetOf(board));
          ASSERT_TRUE(result.view.found) << squares_x << squares_y << legacy << inverted << result.view.why_not;
          EXPECT_EQ(result.view.corner_idx.size(), static_cast<std::size_t>((squares_x - 1) * (squares_y - 1)));
          EXPECT_LT(ErrorsOf(result.view, Truth(scene, board)).rms_px, 0.1);
        }
}

TEST(DetectCharuco, SaysThatTheLayoutIsTheOtherOne) {
  Charuco board{5, 6};
  const Scene scene = Looking({0.06, 0.08}, 0.45, 0.4, 0.3);
  Target declared = TargetOf(board);
  declared.legacy_layout = true;
  AnnotatedView result = DetectIn(Photographed(scene, Drawn(board)), declared);
  EXPECT_FALSE(result.view.found);
  EXPECT_THAT(result.view.why_not, HasSubstr("set legacy_layout: false"));
  board.legacy = true;
  declared.legacy_layout = false;
  result = DetectIn(Photographed(scene, Drawn(board)), declared);
  EXPECT_FALSE(result.view.found);
  EXPECT_THAT(result.view.why_not, HasSubstr("looks like the legacy layout: set legacy_layout: true"));
}

TEST(DetectCharuco, FindsTheCornersInsideThePictureThroughALens) {
  Scene scene = Looking(kCentre, 0.25, 0.8, 0.3, 0.2, 0.05, 0.03);
  scene.k1 = -0.35, scene.k2 = 0.15, scene.p1 = 0.002;
  const auto truth = Truth(scene, kBoard);
  const AnnotatedView result = DetectIn(Photographed(scene, Drawn(kBoard)), TargetOf(kBoard));
  ASSERT_TRUE(result.view.found) << result.view.why_not;
  EXPECT_GE(result.view.corner_idx.size(), 18u);
  EXPECT_LT(result.view.corner_idx.size(), 24u);
  EXPECT_LT(ErrorsOf(result.view, truth).rms_px, 0.1);
}

// A corner at the very edge of the hand may be pulled a little.
TEST(DetectCharuco, AHandOverTheBoardHidesOnlyWhatIsUnderIt) {
  const Scene scene = Looking(kCentre, 0.5, 0.3, 0.2);
  const Eigen::Vector2d hand(0.045, 0.11);
  const AnnotatedView result = DetectIn(Photographed(scene, Covered(Drawn(kBoard), hand, 0.048)), TargetOf(kBoard));
  ASSERT_TRUE(result.view.found) << result.view.why_not;
  EXPECT_GE(result.view.corner_idx.size(), 14u);
  const Errors errors = ErrorsOf(result.view, Truth(scene, kBoard));
  EXPECT_LT(errors.rms_px, 0.2);
  EXPECT_LT(errors.largest_px, 0.8);
  for (const int idx : result.view.corner_idx)
    EXPECT_GT((Eigen::Vector2d(idx % 4, idx / 4) * 0.04 - hand).norm(), 0.045) << idx;
}

// A board printed on both sides back to back: the same points, seen the other way round.
TEST(DetectCharuco, FindsTheBoardFromBehind) {
  const Scene scene = Looking(kCentre, 0.5, 0.3, 0.2 + M_PI, 0.1);
  const AnnotatedView result = DetectIn(Photographed(scene, Drawn(kBoard)), TargetOf(kBoard));
  ASSERT_TRUE(result.view.found) << result.view.why_not;
  EXPECT_EQ(result.view.corner_idx.size(), 24u);
  EXPECT_LT(ErrorsOf(result.view, Truth(scene, kBoard)).rms_px, 0.1);
}

TEST(DetectCharuco, FindsSmallMarkers) {
  const Scene scene = Looking(kCentre, 1.0, 0.3, 0.2);  // squares of 24 px, markers of 18 px
  const AnnotatedView result = DetectIn(Photographed(scene, Drawn(kBoard)), TargetOf(kBoard));
  ASSERT_TRUE(result.view.found) << result.view.why_not;
  EXPECT_EQ(result.view.corner_idx.size(), 24u);
  EXPECT_LT(ErrorsOf(result.view, Truth(scene, kBoard)).rms_px, 0.15);
}

TEST(DetectCharuco, ReadsDeepAndColouredPictures) {
  const Scene scene = Looking(kCentre, 0.5, 0.3, 0.2);
  const cv::Mat grey = Photographed(scene, Drawn(kBoard));
  cv::Mat deep, colour;
  grey.convertTo(deep, CV_16U, 16);
  cv::cvtColor(grey, colour, cv::COLOR_GRAY2BGR);
  for (const cv::Mat& picture : {deep, colour}) {
    const AnnotatedView result = DetectIn(picture, TargetOf(kBoard));
    ASSERT_TRUE(result.view.found) << result.view.why_not;
    EXPECT_LT(ErrorsOf(result.view, Truth(scene, kBoard)).rms_px, 0.15);
  }
}

TEST(DetectCharuco, ThrowsOutAMarkerInTheWrongPlace) {
  const Scene scene = Looking(kCentre, 0.5, 0.3, 0.2);
  Charuco stray{2, 2, 0.06, 0.045};  // its marker 0 beside the board, as another sheet on the wall
  const Pattern sheet = Drawn(stray), board = Drawn(kBoard);
  const cv::Mat picture = Photographed(scene, [&](double x_m, double y_m) {
    const double grey = board(x_m, y_m);
    return grey < 0 ? sheet(x_m - 0.24, y_m - 0.05) : grey;
  });
  const AnnotatedView result = DetectIn(picture, TargetOf(kBoard));
  ASSERT_TRUE(result.view.found) << result.view.why_not;
  EXPECT_EQ(result.view.corner_idx.size(), 24u);
  EXPECT_LT(ErrorsOf(result.view, Truth(scene, kBoard)).largest_px, 0.3);
}

TEST(DetectCharuco, SaysWhyNot) {
  const Target target = TargetOf(kBoard);
  const auto why_not = [&](const cv::Mat& picture) { return DetectIn(picture, target).view.why_not; };
  EXPECT_THAT(why_not(cv::Mat(480, 640, CV_8U, cv::Scalar(90))), HasSubstr("no marker of DICT_4X4_50 was read"));
  EXPECT_THAT(why_not(cv::Mat(1, 1, CV_8U, cv::Scalar(90))), HasSubstr("no charuco board"));
  EXPECT_THAT(why_not(cv::Mat(3, 700, CV_8U, cv::Scalar(90))), HasSubstr("no charuco board"));
  const Charuco wide{7, 5};
  EXPECT_THAT(why_not(Photographed(Looking({0.1, 0.06}, 0.5, 0), Drawn(wide))), HasSubstr("not placed as on it"));
  const Scene corner = Looking({-0.03, -0.03}, 0.14, 0, 0);
  EXPECT_THAT(why_not(Photographed(corner, Drawn(kBoard))), HasSubstr("in the picture"));
}

TEST(DetectCharuco, RefusesMarkersOfAnotherBoard) {
  const TagGrid others{4, 4, 0.03, 0.5, "DICT_4X4_50", 1, 0, 30, false};
  const AnnotatedView result = DetectIn(Photographed(Looking({0.08, 0.08}, 0.5, 0.2), Drawn(others)), TargetOf(kBoard));
  EXPECT_FALSE(result.view.found);
  EXPECT_THAT(result.view.why_not, HasSubstr("ids that this board does not have"));
}

TEST(DetectCharuco, RefusesBoardsThatCannotBe) {
  const cv::Mat picture(48, 64, CV_8U, cv::Scalar(90));
  Target target = TargetOf(kBoard);
  target.dictionary = "DICT_9X9";
  EXPECT_THAT(DetectIn(picture, target).view.why_not, HasSubstr("is not known"));
  target = TargetOf(kBoard);
  target.cols = 20;
  EXPECT_THAT(DetectIn(picture, target).view.why_not, HasSubstr("DICT_4X4_50 has 50"));
  target.cols = 1;
  EXPECT_THAT(DetectIn(picture, target).view.why_not, HasSubstr("too small"));
  target.cols = 0;
  EXPECT_THAT(DetectIn(picture, target).view.why_not, HasSubstr("both counts"));
}

TEST(DetectCharuco, TheThreadCountDoesNotMatter) {
  const cv::Mat picture = Photographed(Looking(kCentre, 0.5, 0.7, 0.3), Drawn(kBoard));
  const int before = cv::getNumThreads();
  cv::setNumThreads(1);
  const AnnotatedView one = DetectIn(picture, TargetOf(kBoard));
  cv::setNumThreads(4);
  const AnnotatedView four = DetectIn(picture, TargetOf(kBoard));
  cv::setNumThreads(before);
  ASSERT_TRUE(one.view.found);
  EXPECT_EQ(one.view.corners_px, four.view.corners_px);
  EXPECT_EQ(one.picture, four.picture);
}

TEST(DetectorKey, NamesWhatChangesTheCornersOfACharucoBoard) {
  const Target target = TargetOf(kBoard);
  std::vector<Target> others(6, target);
  others[0].legacy_layout = true;
  others[1].dictionary = "DICT_4X4_100";
  others[2].marker_m = 0.02;
  others[3].id = TargetId("other");
  others[4].kind = TargetKind::kCheckerboard;
  others[5].marker_ids.resize(static_cast<std::size_t>(MarkerCountOf(target)), 3);
  for (const Target& other : others) EXPECT_NE(DetectorKey(target), DetectorKey(other));
  Target larger = target;
  larger.square_m *= 2, larger.marker_m *= 2;
  EXPECT_EQ(DetectorKey(target), DetectorKey(larger));
}

}  // namespace
}  // namespace rigcal::detect
