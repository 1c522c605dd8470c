#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/report/text/figure_words.h"
#include "server/report/text/text.h"
#include "tests/unit/report/sample.h"

namespace rigcal::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string Joined(const std::vector<FigureRow>& rows) {
  std::string text;
  for (const FigureRow& row : rows) text += row.name + " = " + row.value + "\n";
  return text;
}

Edge EdgeWith(std::map<std::string, double> figures) {
  Edge edge;
  edge.frame_a = SensorId("left"), edge.frame_b = SensorId("top");
  edge.figures = std::move(figures);
  return edge;
}

TEST(FigureWords, NumbersThatBelongTogetherAreOneRowInTheirOrder) {
  const FigureRows rows = RowsOf(EdgeWith({{"captures_total", 30},
                                           {"captures_used", 29},
                                           {"motion_rms_m", 0.0012},
                                           {"motion_rms_rad", M_PI / 180},
                                           {"noise_b_m", 0.002},
                                           {"noise_b_rad", M_PI / 90}}));
  EXPECT_EQ(Joined(rows.checks),
            "Captures used = 29 of 30\nMotions of left and top differ by, rms = 1.200 mm, 1.000 deg\n"
            "Noise of one pose of top = 2.000 mm, 2.000 deg\n");
}

TEST(FigureWords, WithoutAUsedCaptureTheirNumberIsLeft) {
  EXPECT_EQ(Joined(RowsOf(EdgeWith({{"captures_total", 16}})).checks), "Captures = 16\n");
}

TEST(FigureWords, AValueHasTheDecimalsOfItsSigma) {
  const FigureRows rows = RowsOf(EdgeWith({{"clock_offset_s", -126.83591234},
                                           {"clock_offset_sigma_s", 0.0015},
                                           {"board_scale_ratio", 0.00062},
                                           {"board_scale_sigma_ratio", 0.00157},
                                           {"range_bias_m", 0.0},
                                           {"range_bias_sigma_m", 0.0}}));
  EXPECT_EQ(Joined(rows.checks),
            "Boards larger than given by = 0.06 \xC2\xB1 0.16 %\nClock of left ahead of top by = -126.8359 \xC2\xB1 "
            "0.0015 s\n");
}

TEST(FigureWords, LensValuesAreApartAndUnknownFiguresKeepTheirNames) {
  const FigureRows rows =
      RowsOf(EdgeWith({{"fx_a_px", 700.25}, {"k1_b_ratio", -0.08}, {"cy_px", 510}, {"my_own_m", 0.5}}));
  EXPECT_EQ(Joined(rows.checks), "my own = 500.0 mm\n");
  EXPECT_EQ(Joined(rows.lens), "fx of left = 700.25 px\ncy = 510 px\nk1 of top = -0.08\n");
}

TEST(FigureWords, FilesOfAFailedPairAreCountedWithoutTheirPlaces) {
  EXPECT_EQ(Joined(RowsOf(EdgeWith({{"files_a", 6},
                                    {"files_with_board_a", 2},
                                    {"files_unreadable_a", 3},
                                    {"first_unreadable_a_idx", 4},
                                    {"rms_as_fisheye_kb4_b_px", 0.21}}))
                       .checks),
            "Files of left that show a board = 2 of 6\nFiles of left that cannot be read = 3\n"
            "Reprojection error in top alone as fisheye_kb4, rms = 0.2100 px\n");
}

TEST(FigureWords, NumbersOfSphereModelsStandWithTheLens) {
  const FigureRows rows = RowsOf(EdgeWith(
      {{"alpha_a_ratio", 0.61}, {"beta_a_ratio", 1.07}, {"fx_a_px", 700.25}, {"xi_b_ratio", -0.22}, {"rms_px", 0.1}}));
  EXPECT_EQ(Joined(rows.lens),
            "fx of left = 700.25 px\nxi of top = -0.22\nalpha of left = 0.61\nbeta of left = 1.07\n");
  EXPECT_EQ(Joined(rows.checks), "Reprojection error, rms = 0.1000 px\n");
}

TEST(FigureWords, MethodsHaveNames) {
  EXPECT_EQ(MethodText("lidar_camera"), "lidar-camera");
  EXPECT_EQ(MethodText("theirs_2"), "theirs_2");
}

TEST(FigureWords, APolishedPoseIsNotThePlainMethods) {
  Edge edge = EdgeWith({{"polished_ratio", 0}});
  edge.method = "lidar_lidar";
  EXPECT_EQ(MethodText(edge), "lidar-lidar");
  EXPECT_EQ(Joined(RowsOf(edge).checks), "Answer from = NDT\n");
  edge.figures["polished_ratio"] = 1;
  EXPECT_EQ(MethodText(edge), "lidar-lidar, polished by GICP");
  EXPECT_EQ(Joined(RowsOf(edge).checks), "Answer from = GICP\n");
}

TEST(ReportEdges, APolishedOneIsMarkedInTableSectionAndSpreadsheet) {
  ReportInput input = SampleReport();
  Edge& edge = input.revision.edges[1];
  edge.method = "lidar_lidar";
  const auto files = [&] { return RenderRevision(input, "{}").value(); };
  EXPECT_THAT(files().at("index.html"), Not(HasSubstr("polished")));
  EXPECT_THAT(files().at("edges.csv"), HasSubstr(",lidar_lidar,"));
  edge.figures["polished_ratio"] = 1;
  const std::string page = files().at("index.html");
  EXPECT_THAT(page, HasSubstr("<td class=\"text\"><bdi>lidar-lidar, polished by GICP</bdi></td>"));
  EXPECT_THAT(page, HasSubstr("<span class=\"soft\"><bdi>lidar-lidar, polished by GICP</bdi></span>"));
  EXPECT_THAT(files().at("edges.csv"), HasSubstr(",lidar_lidar+gicp,"));
}

TEST(ReportText, AsCertainAsItsSigma) {
  EXPECT_EQ(AsCertainAs(123.456, 0.25), "123.46");
  EXPECT_EQ(AsCertainAs(123.456, 25), "123");
  EXPECT_EQ(AsCertainAs(-0.00001, 0.0021), "0.0000");
  EXPECT_EQ(AsCertainAs(1.5, 0.0), "1.5");
  EXPECT_EQ(AsCertainAs(-0.0096, 0.0), "-0.0096");
  EXPECT_EQ(AsCertainAs(700.0, 0.0), "700");
}

// A pose stream has no captures to draw and no pictures: what it says of itself is all there is to see.
TEST(ReportEdges, AnEdgeWithFiguresAloneHasASection) {
  ReportInput input = SampleReport();
  Edge& edge = input.revision.edges[1];
  edge.captures.clear(), edge.evidence.clear(), edge.diagnoses.clear();
  edge.figures.clear();
  EXPECT_THAT(PageOf(input), Not(HasSubstr("id=\"e-" + edge.id.str().substr(0, 16))));
  edge.figures["clock_offset_s"] = 0.024;
  EXPECT_THAT(PageOf(input), HasSubstr("id=\"e-" + edge.id.str().substr(0, 16)));
}

// Zero by construction is no residual.
TEST(ReportEdges, WhatNothingChecksHasNoResidual) {
  ReportInput input = SampleReport();
  input.revision.solution.dof = 0;
  const std::string page = PageOf(input);
  const std::string table = page.substr(page.find("id=\"edges\""));
  EXPECT_THAT(table.substr(0, table.find("</table>")),
              HasSubstr("<td data-v=\"\" class=\"soft\">nothing checks it</td>"));
}

}  // namespace
}  // namespace rigcal::report
