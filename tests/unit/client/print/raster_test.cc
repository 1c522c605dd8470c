// Printed boards, drawn by other programs and found by the project's own detector: kind, numbering and true size.
#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <span>

#include "server/detect/board.h"
#include "tests/unit/client/print/rasterised.h"

namespace rigcal::print {
namespace {

Target Checkerboard() {
  Target target;
  target.id = TargetId("board"), target.cols = 7, target.rows = 5, target.square_m = 0.02, target.serial = "B-1";
  return target;
}

Target Charuco(bool legacy = false) {
  Target target = Checkerboard();
  target.kind = TargetKind::kCharuco, target.cols = 6, target.rows = 5, target.square_m = 0.025;
  target.marker_m = 0.018, target.dictionary = "DICT_5X5_50", target.legacy_layout = legacy;
  return target;
}

Target TagGrid(TargetKind kind) {
  Target target = Checkerboard();
  target.kind = kind, target.cols = 5, target.rows = 3, target.square_m = 0.03, target.spacing_ratio = 0.3;
  target.dictionary = kind == TargetKind::kAprilGrid ? "DICT_APRILTAG_36h11" : "DICT_6X6_250";
  return target;
}

Target Circles(TargetKind kind) {
  Target target = Checkerboard();
  const bool asymmetric = kind == TargetKind::kAsymmetricCircleGrid;
  target.kind = kind, target.cols = asymmetric ? 4 : 6, target.rows = asymmetric ? 9 : 5;
  target.square_m = 0.02, target.diameter_m = asymmetric ? 0.015 : 0.011;
  return target;
}

// Pixel of a place on the sheet: the centre of the first pixel is 0, 0.
double PixelOf(double at_m) { return at_m * kPixelsPerMetre - 0.5; }

// Where the first point of the target lies on the sheet.
Eigen::Vector2d FirstPoint_m(const Target& target, const Sheet& sheet) {
  const double inset_m = IsCircleGrid(target.kind)               ? target.diameter_m / 2
                         : !IsTagGrid(target.kind)               ? target.square_m
                         : target.kind == TargetKind::kAprilGrid ? target.square_m * target.spacing_ratio
                                                                 : 0;
  return {sheet.pattern_x_m + inset_m, sheet.pattern_y_m + inset_m};
}

struct Case {
  const char* name;
  Target target;
  const char* suffix;
};

struct Photograph {
  std::string png;
  cv::Matx23d placed;  // pixel of the raster -> pixel of the photograph

  [[nodiscard]] Eigen::Vector2d PixelOf(const Eigen::Vector2d& at_m) const {
    const cv::Vec2d pixel = placed * cv::Vec3d(print::PixelOf(at_m.x()), print::PixelOf(at_m.y()), 1);
    return {pixel[0], pixel[1]};
  }
};

// As a camera sees it: a degree askew, and no edge of a single pixel. A blur that is the same to all sides moves none.
Photograph Photographed(const std::string& png) {
  const cv::Mat picture = cv::imdecode(std::vector<char>(png.begin(), png.end()), cv::IMREAD_GRAYSCALE);
  const cv::Mat turn = cv::getRotationMatrix2D({picture.cols / 2.0f, picture.rows / 2.0f}, 1.0, 1.0);
  cv::Mat seen;
  cv::warpAffine(picture, seen, turn, picture.size(), cv::INTER_LINEAR, cv::BORDER_CONSTANT, 255);
  cv::GaussianBlur(seen, seen, {}, 1.0);
  std::vector<unsigned char> encoded;
  cv::imencode(".png", seen, encoded);
  return {{encoded.begin(), encoded.end()}, turn};
}

class RasterTest : public testing::TestWithParam<Case> {};

TEST_P(RasterTest, TheDetectorFindsEveryPointWhereItBelongs) {
  const Target& target = GetParam().target;
  const Sheet sheet = LayOut(target, "auto").value();
  const std::string text =
      GetParam().suffix == std::string(".pdf") ? WritePdf(sheet, "board").value() : WriteSvg(sheet, "board");
  const auto png = Rasterised(text, GetParam().suffix);
  if (!png) GTEST_SKIP() << "no program that rasterises " << GetParam().suffix << " is installed";
  const Photograph photograph = Photographed(*png);
  const AnnotatedView found = detect::Detect(std::as_bytes(std::span(photograph.png)), target);
  ASSERT_TRUE(found.view.found) << found.view.why_not;
  const auto points = TargetPoints(target);
  ASSERT_EQ(found.view.corners_px.size(), points.size());
  const Eigen::Vector2d first_m = FirstPoint_m(target, sheet);
  std::vector<Eigen::Vector2d> seen(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t idx = found.view.corner_idx.empty() ? i : static_cast<std::size_t>(found.view.corner_idx[i]);
    seen[idx] = found.view.corners_px[i];
    const Eigen::Vector2d belongs_px = photograph.PixelOf(first_m + points[idx].head<2>());
    EXPECT_LT((seen[idx] - belongs_px).norm(), 1) << "0.1 mm, point " << idx;
  }
  const Eigen::Vector2d across = seen.back() - seen.front(),
                        is = (points.back() - points.front()).head<2>() * kPixelsPerMetre;
  EXPECT_NEAR(across.norm(), is.norm(), 1) << "the whole board, to 0.1 mm";
}

INSTANTIATE_TEST_SUITE_P(Boards, RasterTest,
                         testing::Values(Case{"checkerboard_pdf", Checkerboard(), ".pdf"},
                                         Case{"checkerboard_svg", Checkerboard(), ".svg"},
                                         Case{"charuco_pdf", Charuco(), ".pdf"}, Case{"charuco_svg", Charuco(), ".svg"},
                                         Case{"legacy_charuco_svg", Charuco(true), ".svg"},
                                         Case{"april_grid_pdf", TagGrid(TargetKind::kAprilGrid), ".pdf"},
                                         Case{"april_grid_svg", TagGrid(TargetKind::kAprilGrid), ".svg"},
                                         Case{"aruco_grid_svg", TagGrid(TargetKind::kArucoGrid), ".svg"},
                                         Case{"circles_pdf", Circles(TargetKind::kCircleGrid), ".pdf"},
                                         Case{"circles_svg", Circles(TargetKind::kCircleGrid), ".svg"},
                                         Case{"asymmetric_pdf", Circles(TargetKind::kAsymmetricCircleGrid), ".pdf"},
                                         Case{"asymmetric_svg", Circles(TargetKind::kAsymmetricCircleGrid), ".svg"}),
                         [](const auto& one) { return one.param.name; });

// The middles of dark runs along a row or a column of the picture.
std::vector<double> DarkRuns(const cv::Mat& line) {
  std::vector<double> middles;
  int first = -1;
  for (int i = 0; i < static_cast<int>(line.total()); ++i) {
    const bool dark = line.at<std::uint8_t>(i) < 128;
    if (dark && first < 0) first = i;
    if (!dark && first >= 0) middles.push_back((first + i - 1) / 2.0), first = -1;
  }
  return middles;
}

// Between the ends of the lines of 50 mm and of 100 mm there are only the latter.
TEST(Rulers, AreAsLongAsTheySay) {
  Target target = Checkerboard();
  target.square_m = 0.035;
  const Sheet sheet = LayOut(target, "A3").value();
  EXPECT_NEAR(sheet.ruler_x_m, 0.3, 1e-12);
  EXPECT_NEAR(sheet.ruler_y_m, 0.2, 1e-12);
  for (const char* suffix : {".pdf", ".svg"}) {
    const auto png =
        Rasterised(suffix == std::string(".pdf") ? WritePdf(sheet, "board").value() : WriteSvg(sheet, "board"), suffix);
    if (!png) GTEST_SKIP() << "no program that rasterises " << suffix << " is installed";
    const cv::Mat picture = cv::imdecode(std::vector<char>(png->begin(), png->end()), cv::IMREAD_GRAYSCALE);
    EXPECT_NEAR(picture.cols, 4200, 1) << suffix;
    EXPECT_NEAR(picture.rows, 2970, 1) << suffix;
    const double left_m = 0.024, bottom_m = sheet.height_m - 0.054;  // the corner where both rulers meet
    const cv::Mat row = picture.row(static_cast<int>((bottom_m + 0.0051) * kPixelsPerMetre));
    std::vector<double> lines;
    for (const double at : DarkRuns(row.clone()))
      if (lines.empty() ? std::abs(at - PixelOf(left_m)) < 3 : std::abs(at - lines.back() - 1000) < 3)
        lines.push_back(at);
    ASSERT_EQ(lines.size(), 4u) << suffix;
    EXPECT_NEAR(lines.back() - lines.front(), 3000, 1) << suffix << ", 0.1 mm";
    const cv::Mat column = picture.col(static_cast<int>((left_m - 0.0051) * kPixelsPerMetre)).clone();
    lines.clear();
    for (const double at : DarkRuns(column))
      if (lines.empty() ? std::abs(at - PixelOf(0.010)) < 3 : std::abs(at - lines.back() - 1000) < 3)
        lines.push_back(at);
    ASSERT_EQ(lines.size(), 3u) << suffix;
    EXPECT_NEAR(lines.back() - lines.front(), 2000, 1) << suffix << ", 0.1 mm";
  }
}

}  // namespace
}  // namespace rigcal::print
