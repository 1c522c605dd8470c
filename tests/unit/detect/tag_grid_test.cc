#include <gmock/gmock.h>

#include <opencv2/imgproc.hpp>
#include <set>

#include "tests/unit/detect/rendering.h"

namespace rigcal::detect {
namespace {

using testing::HasSubstr;

const TagGrid kKalibr;  // 6 x 6 tags of 30 mm
const TagGrid kOpenCv{5, 4, 0.03, 0.3, "DICT_6X6_250", 1, 0, 0, false};
const Eigen::Vector2d kCentre(0.11, 0.11), kOpenCvCentre(0.092, 0.072);

void ExpectFound(const TagGrid& grid, const Scene& scene, std::size_t tags_min, double rms_max_px) {
  const AnnotatedView result = DetectIn(Photographed(scene, Drawn(grid)), TargetOf(grid));
  ASSERT_TRUE(result.view.found) << result.view.why_not;
  EXPECT_GE(result.view.corner_idx.size(), 4 * tags_min);
  EXPECT_TRUE(std::is_sorted(result.view.corner_idx.begin(), result.view.corner_idx.end()));
  const Errors errors = ErrorsOf(result.view, Truth(scene, grid));
  EXPECT_LT(errors.rms_px, rms_max_px);
  EXPECT_LT(errors.largest_px, 0.5);
  EXPECT_FALSE(result.picture.empty());
}

TEST(DetectTagGrid, FindsTheTrueCornersHoweverTheBoardIsTurned) {
  for (int step = 0; step < 6; ++step) {
    SCOPED_TRACE(step);
    ExpectFound(kKalibr, Looking(kCentre, 0.5, step * M_PI / 3 + 0.1, 0.4, -0.2), 35, 0.1);
    ExpectFound(kOpenCv, Looking(kOpenCvCentre, 0.45, step * M_PI / 3 + 0.1, 0.4, -0.2), 20, 0.1);
  }
}

// Borders of one and two bits under both numberings, and codes turned by any quarter against OpenCV's.
TEST(DetectTagGrid, FindsEveryPrint) {
  for (const bool kalibr : {false, true})
    for (const int border_bits : {1, 2})
      for (int turns = 0; turns < 4; ++turns) {
        SCOPED_TRACE(testing::Message() << kalibr << border_bits << turns);
        const TagGrid grid{4, 3, 0.04, 0.25, "DICT_APRILTAG_36h11", border_bits, turns, 0, kalibr};
        ExpectFound(grid, Looking({0.095, 0.07}, 0.5, 0.5, 0.3, 0.2), 12, 0.1);
      }
}

TEST(DetectTagGrid, FindsTagsOfTwentyPixels) {
  ExpectFound(kKalibr, Looking(kCentre, 0.9, 0.3, 0.2, -0.2), 30, 0.15);
  ExpectFound(kOpenCv, Looking(kOpenCvCentre, 0.9, 0.3, 0.2, -0.2), 19, 0.25);
}

TEST(DetectTagGrid, FindsTheTagsInsideThePictureThroughALens) {
  Scene scene = Looking(kCentre, 0.28, 0.5, 0.3, 0.2, 0.06, 0.04);
  scene.k1 = -0.3, scene.k2 = 0.1, scene.p2 = -0.002;
  const auto truth = Truth(scene, kKalibr);
  const AnnotatedView result = DetectIn(Photographed(scene, Drawn(kKalibr)), TargetOf(kKalibr));
  ASSERT_TRUE(result.view.found) << result.view.why_not;
  EXPECT_GE(result.view.corner_idx.size(), 4u * 12);
  EXPECT_LT(result.view.corner_idx.size(), 4u * 36);
  EXPECT_LT(ErrorsOf(result.view, truth).rms_px, 0.15);
}

TEST(DetectTagGrid, AHandOverTheBoardHidesOnlyWhatIsUnderIt) {
  const Scene scene = Looking(kCentre, 0.5, 0.3, 0.2);
  const cv::Mat picture = Photographed(scene, Covered(Drawn(kKalibr), {0.09, 0.12}, 0.05));
  const AnnotatedView result = DetectIn(picture, TargetOf(kKalibr));
  ASSERT_TRUE(result.view.found) << result.view.why_not;
  EXPECT_GE(result.view.corner_idx.size(), 4u * 18);
  EXPECT_LT(ErrorsOf(result.view, Truth(scene, kKalibr)).largest_px, 0.5);
}

TEST(DetectTagGrid, FindsTheBoardFromBehind) {
  ExpectFound(kOpenCv, Looking(kOpenCvCentre, 0.45, 0.3, 0.2 + M_PI, 0.1), 20, 0.1);
}

TEST(DetectTagGrid, TwoTagsOfAGridAreEnoughAndOneIsNot) {
  const TagGrid pair{2, 1, 0.03, 0.3, "DICT_6X6_250", 1, 0, 0, false};
  ExpectFound(pair, Looking({0.035, 0.015}, 0.4, 0.3, 0.2), 2, 0.1);
  TagGrid one = pair;
  one.cols = 1;
  const cv::Mat picture = Photographed(Looking({0.015, 0.015}, 0.4, 0.3, 0.2), Drawn(one));
  EXPECT_FALSE(DetectIn(picture, TargetOf(pair)).view.found);
}

TEST(DetectTagGrid, ASingleTagIsABoardOfItsOwn) {
  const TagGrid one{1, 1, 0.06, 0.3, "DICT_6X6_250", 1, 0, 17, false};
  Target target = TargetOf(one);
  target.marker_ids = {17};
  for (int step = 0; step < 6; ++step) {
    SCOPED_TRACE(step);
    const Scene scene = Looking({0.03, 0.03}, 0.4, step * M_PI / 3 + 0.1, 0.5, -0.2);
    const AnnotatedView result = DetectIn(Photographed(scene, Drawn(one)), target);
    ASSERT_TRUE(result.view.found) << result.view.why_not;
    EXPECT_EQ(result.view.corner_idx, (std::vector<int>{0, 1, 2, 3}));
    EXPECT_LT(ErrorsOf(result.view, Truth(scene, one)).rms_px, 0.1);
  }
  target.marker_ids = {18};
  const cv::Mat picture = Photographed(Looking({0.03, 0.03}, 0.4, 0.3, 0.2), Drawn(one));
  EXPECT_THAT(DetectIn(picture, target).view.why_not, HasSubstr("have ids that this board does not have"));
}

// Which of two is the board, nobody can tell.
TEST(DetectTagGrid, ASingleTagThatIsSeenTwiceIsNotFound) {
  const TagGrid one{1, 1, 0.03, 0.3, "DICT_6X6_250", 1, 0, 0, false};
  const auto tag = Drawn(one);
  const cv::Mat picture = Photographed(Looking({0.05, 0.015}, 0.4, 0.3, 0.2), [&](double x_m, double y_m) {
    return x_m < 0.05 ? tag(x_m, y_m) : tag(x_m - 0.07, y_m);
  });
  const AnnotatedView result = DetectIn(picture, TargetOf(one));
  EXPECT_FALSE(result.view.found);
  EXPECT_THAT(result.view.why_not, HasSubstr("its tag is in it 2 times"));
}

// Two tags of a grid that stand where others belong do not agree with the rest.
TEST(DetectTagGrid, TagsAreTakenByTheirOwnIds) {
  TagGrid grid = kKalibr;
  grid.first_id = 100;
  Target target = TargetOf(grid);
  for (int i = 0; i < 36; ++i) target.marker_ids.push_back(100 + i);
  const Scene scene = Looking(kCentre, 0.5, 0.3, 0.2);
  const cv::Mat picture = Photographed(scene, Drawn(grid));
  const AnnotatedView whole = DetectIn(picture, target);
  ASSERT_TRUE(whole.view.found) << whole.view.why_not;
  EXPECT_EQ(whole.view.corner_idx.size(), 4u * 36);
  EXPECT_LT(ErrorsOf(whole.view, Truth(scene, grid)).rms_px, 0.1);
  std::swap(target.marker_ids[3], target.marker_ids[22]);
  const AnnotatedView swapped = DetectIn(picture, target);
  ASSERT_TRUE(swapped.view.found) << swapped.view.why_not;
  EXPECT_EQ(swapped.view.corner_idx.size(), 4u * 34);
  EXPECT_LT(ErrorsOf(swapped.view, Truth(scene, grid)).rms_px, 0.1);
}

TEST(DetectTagGrid, ReadsDeepAndColouredPictures) {
  const Scene scene = Looking(kOpenCvCentre, 0.45, 0.3, 0.2);
  const cv::Mat grey = Photographed(scene, Drawn(kOpenCv));
  cv::Mat deep, colour;
  grey.convertTo(deep, CV_16U, 16);
  cv::cvtColor(grey, colour, cv::COLOR_GRAY2BGR);
  for (const cv::Mat& picture : {deep, colour}) {
    const AnnotatedView result = DetectIn(picture, TargetOf(kOpenCv));
    ASSERT_TRUE(result.view.found) << result.view.why_not;
    EXPECT_LT(ErrorsOf(result.view, Truth(scene, kOpenCv)).rms_px, 0.15);
  }
}

TEST(DetectTagGrid, LeavesOutATagThatWasPastedOver) {
  const Scene scene = Looking(kOpenCvCentre, 0.45, 0.3, 0.2);
  const TagGrid other{1, 1, 0.03, 0.3, "DICT_6X6_250", 1, 0, 3, false};  // tag 3 where tag 6 belongs
  const Pattern board = Drawn(kOpenCv), sticker = Drawn(other);
  const cv::Mat picture = Photographed(scene, [&](double x_m, double y_m) {
    const double x = x_m - 0.039, y = y_m - 0.039;
    return x >= 0 && y >= 0 && x < 0.03 && y < 0.03 ? sticker(x, y) : board(x_m, y_m);
  });
  const AnnotatedView result = DetectIn(picture, TargetOf(kOpenCv));
  ASSERT_TRUE(result.view.found) << result.view.why_not;
  std::set<int> tags;
  for (const int idx : result.view.corner_idx) tags.insert(idx / 4);
  EXPECT_EQ(tags.size(), 19u);
  EXPECT_EQ(tags.count(6), 0u);
  EXPECT_LT(ErrorsOf(result.view, Truth(scene, kOpenCv)).largest_px, 0.5);
}

TEST(DetectTagGrid, SaysWhyNot) {
  const auto why_not = [](const cv::Mat& picture, const TagGrid& grid) {
    return DetectIn(picture, TargetOf(grid)).view.why_not;
  };
  EXPECT_THAT(why_not(cv::Mat(480, 640, CV_8U, cv::Scalar(90)), kKalibr), HasSubstr("no tag of DICT_APRILTAG_36h11"));
  EXPECT_THAT(why_not(cv::Mat(1, 1, CV_8U, cv::Scalar(90)), kKalibr), HasSubstr("no grid of 6 x 6 tags"));
  TagGrid strangers = kOpenCv;
  strangers.first_id = 100;
  const Scene scene = Looking(kOpenCvCentre, 0.45, 0.3, 0.2);
  EXPECT_THAT(why_not(Photographed(scene, Drawn(strangers)), kOpenCv), HasSubstr("ids that this board does not have"));
  TagGrid counted_wrong = kOpenCv;
  counted_wrong.cols = 4, counted_wrong.rows = 5;
  EXPECT_THAT(why_not(Photographed(scene, Drawn(kOpenCv)), counted_wrong), HasSubstr("not placed as on it"));
}

TEST(DetectTagGrid, SaysThatTheNumberingIsTheOtherOne) {
  const Scene scene = Looking(kCentre, 0.5, 0.3, 0.2);
  Target declared = TargetOf(kKalibr);
  declared.kind = TargetKind::kArucoGrid;
  EXPECT_THAT(DetectIn(Photographed(scene, Drawn(kKalibr)), declared).view.why_not, HasSubstr("set type: april_grid"));
  declared = TargetOf(kOpenCv);
  declared.kind = TargetKind::kAprilGrid;
  const cv::Mat picture = Photographed(Looking(kOpenCvCentre, 0.45, 0.3), Drawn(kOpenCv));
  EXPECT_THAT(DetectIn(picture, declared).view.why_not, HasSubstr("set type: aruco_grid"));
}

TEST(DetectorKey, NamesWhatChangesTheCornersOfATagGrid) {
  const Target target = TargetOf(kKalibr);
  std::vector<Target> others(4, target);
  others[0].kind = TargetKind::kArucoGrid;
  others[1].dictionary = "DICT_APRILTAG_36h10";
  others[2].spacing_ratio = 0.25;
  others[3].rows = 5;
  for (const Target& other : others) EXPECT_NE(DetectorKey(target), DetectorKey(other));
}

}  // namespace
}  // namespace rigcal::detect
