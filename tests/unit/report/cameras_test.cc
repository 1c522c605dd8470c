// What the report says and draws of each camera.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "server/formats/edges/camera_fit.h"
#include "server/report/cameras/camera_drawing.h"
#include "tests/unit/report/sample.h"

namespace rigcal::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

ViewFit ViewWith(const std::vector<Eigen::Vector2d>& uv_px, const Eigen::Vector2d& residual_px) {
  ViewFit view;
  view.capture = CaptureId("01");
  view.uv_px = uv_px;
  view.residual_px.assign(uv_px.size(), residual_px);
  view.distance_m = 2.0;
  view.tilt_rad = {0.5, 0.0};
  return view;
}

CameraFit FitWith(std::vector<ViewFit> views) {
  CameraFit fit;
  fit.camera = SensorId("front_left");
  fit.width_px = 1200, fit.height_px = 900;
  fit.source = IntrinsicsSource::kEstimated;
  fit.intrinsics = {700.123456, 700.0, 600.0, 450.0, {-0.1, 0.02, 0.0, 0.001, 0.0}, CameraModel::kPinholeRadtan};
  fit.sigma = {0.25, 0.25, 0.5, 0.5, 0.001, 0.002, 0.0001, 0.0001, 0.003};
  fit.sigma_by_jackknife = true;
  fit.views = std::move(views);
  return fit;
}

ReportInput ReportWith(CameraFit fit) {
  ReportInput input = SampleReport();
  input.sensors[SensorId("front_left")] = {};
  input.sensors[SensorId("front_right")] = {};
  input.cameras.push_back({std::move(fit), input.revision.edges[0].id, Sha256Of("fit")});
  return input;
}

TEST(CameraShape, CornersCountInTheirField) {
  const Coverage coverage =
      CoverageOf(FitWith({ViewWith({{-0.5, -0.5}, {0, 0}, {1199.4, 899.4}, {599.0, 0.0}}, {0, 0})}));
  ASSERT_EQ(coverage.columns, 12);
  ASSERT_EQ(coverage.rows, 9);
  EXPECT_EQ(coverage.At(0, 0), 2);
  EXPECT_EQ(coverage.At(11, 8), 1);
  EXPECT_EQ(coverage.At(5, 0), 1);
  EXPECT_EQ(std::accumulate(coverage.corners.begin(), coverage.corners.end(), 0), 4);
  EXPECT_NEAR(coverage.share_ratio, 3.0 / 108, 1e-12);
}

TEST(CameraShape, EmptySidesAreNamedEachByItself) {
  const auto margins = [](double left, double right, double top, double bottom) {
    return CoverageOf(FitWith({ViewWith({{left, top}, {right, bottom}}, {0, 0})})).margin_ratio;
  };
  EXPECT_NEAR(margins(239.5, 1199.5, -0.5, 899.5)[0], 0.2, 1e-9);
  EXPECT_NEAR(margins(-0.5, 959.5, -0.5, 899.5)[1], 0.2, 1e-9);
  EXPECT_NEAR(margins(-0.5, 1199.5, 179.5, 899.5)[2], 0.2, 1e-9);
  EXPECT_NEAR(margins(-0.5, 1199.5, -0.5, 719.5)[3], 0.2, 1e-9);
  const auto advice = AdviceOf(FitWith({ViewWith({{-0.5, 179.5}, {1199.5, 899.5}}, {0, 0})}));
  ASSERT_FALSE(advice.empty());
  EXPECT_EQ(advice[0].figure, "empty: top (20 %)");
  EXPECT_THAT(advice[0].text, HasSubstr("top (20 %)"));
  EXPECT_THAT(advice[0].text, Not(HasSubstr("left")));
}

TEST(CameraShape, GivenIntrinsicsNeedNoAdviceAboutPictures) {
  CameraFit fit = FitWith({ViewWith({{600, 450}, {610, 450}}, {0, 0})});
  ASSERT_FALSE(AdviceOf(fit).empty());
  EXPECT_THAT(AdviceOf(fit)[0].text, HasSubstr("Lens distortion"));
  fit.source = IntrinsicsSource::kGiven;
  EXPECT_TRUE(AdviceOf(fit).empty());
}

// The histogram of normal residuals is the normal curve: 20,000 numbers, 6 standard deviations of a bin.
TEST(CameraShape, NormalResidualsFollowTheNormalCurve) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 0.3);
  ViewFit view = ViewWith(std::vector<Eigen::Vector2d>(10'000, {600.0, 450.0}), {0, 0});
  for (Eigen::Vector2d& r : view.residual_px) r = {noise(random), noise(random)};
  const ResidualShape shape = ShapeOf(FitWith({view}));
  EXPECT_NEAR(shape.sigma_px, 0.3, 6 * 0.3 / std::sqrt(2 * 20'000));
  EXPECT_NEAR(shape.beyond_3_ratio, kNormalBeyond3_ratio, 6 * std::sqrt(kNormalBeyond3_ratio / 20'000));
  double area = 0.0;
  for (int bin = 1; bin < kBins - 1; ++bin) {
    const double middle = -kReach + (bin + 0.5) * 2 * kReach / kBins;
    const double wanted = std::exp(-middle * middle / 2) / std::sqrt(2 * M_PI);
    const double sigma = std::sqrt(wanted * kBins / (2 * kReach) / 20'000);
    EXPECT_NEAR(shape.density[static_cast<std::size_t>(bin)], wanted, 6 * sigma + 0.003) << middle;
  }
  for (const double density : shape.density) area += density * 2 * kReach / kBins;
  EXPECT_NEAR(area, 1.0, 1e-9);
}

TEST(CameraShape, OneFarCornerIsCountedAndNeverThinnedAway) {
  ViewFit view = ViewWith(std::vector<Eigen::Vector2d>(5000, {600.0, 450.0}), {0.1, 0.1});
  view.residual_px[4321] = {30.0, 0.0};
  const CameraFit fit = FitWith({view});
  const ResidualShape shape = ShapeOf(fit);
  EXPECT_NEAR(shape.worst_px, 30.0, 1e-12);
  EXPECT_NEAR(shape.beyond_3_ratio, 1.0 / 10'000, 1e-9);
  const std::string page = PageOf(ReportWith(fit));
  EXPECT_THAT(page, HasSubstr("<path class=\"far\""));
  EXPECT_THAT(page, HasSubstr(std::to_string(kVectorsMax + 1) + " of 5000 corners drawn"));
}

// What a field's corners share is what the lens model leaves: here u in the right half alone.
TEST(CameraShape, MeansTellWhereTheModelDoesNotFit) {
  ViewFit view = ViewWith(std::vector<Eigen::Vector2d>(20, {100.0, 450.0}), {0.0, 0.0});
  for (int i = 0; i < 20; ++i) view.uv_px.emplace_back(1100.0, 450.0), view.residual_px.emplace_back(0.5, 0.0);
  const auto means = MeansOf(FitWith({view}));
  ASSERT_EQ(means.size(), 2U);
  EXPECT_LT(means[0].mean_px.norm(), 1e-12);
  EXPECT_NEAR(means[1].mean_px.x(), 0.5, 1e-12);
  EXPECT_NEAR(means[1].at_px.x(), 1100.0, 1e-9);
}

TEST(ReportCameras, PageHasPicturesAndNumbers) {
  const std::string page = PageOf(ReportWith(FitWith({ViewWith({{10, 10}, {1190, 890}, {600, 450}}, {0.3, -0.4})})));
  for (const char* part : {"id=\"cameras\"", "class=\"heat1\"", "class=\"usual\"", "class=\"normal\"",
                           "class=\"compass\"", "700.12 px <span class=\"soft\">\xC2\xB1 0.25</span>",
                           "jackknife over the pictures", "01: tilted 29 deg, 2.00 m away", "rms 0.500 px"})
    EXPECT_THAT(page, HasSubstr(part)) << part;
  EXPECT_THAT(page, HasSubstr("cameras/" + Sha256Of("fit").str() + ".json"));
}

// Of four pictures the three with the largest residuals, the worst first; one that is not stored is not shown.
TEST(ReportCameras, ShowsThePicturesThatFitWorst) {
  std::vector<ViewFit> views;
  for (const double residual_px : {0.1, 0.4, 0.2, 0.3, 9.0})
    views.push_back(ViewWith({{500, 400}, {700, 400}, {700, 500}}, {residual_px, 0.0}));
  for (std::size_t i = 0; i < views.size(); ++i) views[i].capture = CaptureId("v" + std::to_string(i));
  ReportInput input = ReportWith(FitWith(views));
  for (Edge& edge : input.revision.edges) {
    if (edge.id != input.cameras.front().edge) continue;
    for (const ViewFit& view : views) {
      const Digest digest(Sha256Of("worst " + view.capture.str()).str());
      edge.evidence.push_back({"", input.cameras.front().fit.camera, view.capture, digest, "jpg"});
      if (view.capture.str() != "v4") input.evidence.push_back(digest);
    }
  }
  const std::string page = PageOf(input);
  const std::string section = page.substr(page.find("class=\"views\""), 6000);
  EXPECT_EQ(section.find("<bdi>v4</bdi>"), std::string::npos);
  EXPECT_LT(section.find("<bdi>v1</bdi>: rms 0.400 px"), section.find("<bdi>v3</bdi>: rms 0.300 px"));
  EXPECT_LT(section.find("<bdi>v3</bdi>"), section.find("<bdi>v2</bdi>"));
  EXPECT_EQ(section.substr(0, section.find("</details>")).find("<bdi>v0</bdi>"), std::string::npos);
  // Cut to the board, 200 px wide, with room; a line leads from the corner as seen to where the estimate puts it.
  EXPECT_THAT(section, HasSubstr("viewBox=\"476.0 357.0 248.0 186.0\""));
  EXPECT_THAT(section, HasSubstr("lines 10 times as long"));
  EXPECT_THAT(section, HasSubstr("d=\"M500.5 400.5l-4.0 0.0M"));
}

TEST(ReportCameras, WhatWasNotKeptIsSaid) {
  const std::string page = PageOf(ReportWith(FitWith({ViewWith({{10, 10}}, {0.3, -0.4})})));
  EXPECT_THAT(page, HasSubstr("No residuals are kept of <bdi>front_right</bdi>"));
  ReportInput old = SampleReport();
  old.sensors[SensorId("front_left")] = {};
  const std::string old_page = PageOf(old);
  EXPECT_THAT(old_page, HasSubstr("No residuals are kept of <bdi>front_left</bdi>"));
  EXPECT_THAT(PageOf(SampleReport()), Not(HasSubstr("id=\"cameras\"")));
}

TEST(ReportCameras, ACameraThatWasNotSolvedShowsItsCoverage) {
  CameraFit fit = FitWith({ViewWith({{10, 10}}, {0, 0})});
  fit.source = IntrinsicsSource::kNone;
  fit.views[0].residual_px.clear();
  const std::string page = PageOf(ReportWith(fit));
  EXPECT_THAT(page, HasSubstr("class=\"heat1\""));
  EXPECT_THAT(page, HasSubstr("there are no residuals to draw"));
  EXPECT_THAT(page, Not(HasSubstr("class=\"usual\"")));
}

TEST(ReportCameras, NothingOddBecomesANumber) {
  CameraFit fit = FitWith({ViewWith({{NAN, 10}, {INFINITY, -INFINITY}, {1e300, 5}}, {NAN, 0})});
  fit.sigma = {};
  fit.width_px = fit.height_px = 0;
  const std::string page = PageOf(ReportWith(fit));
  const auto from = page.find("id=\"cameras\"");
  const std::string section = page.substr(from, page.find("class=\"card edge failed\"", from) - from);
  EXPECT_THAT(section, Not(HasSubstr("nan")));
  EXPECT_THAT(section, Not(HasSubstr("inf")));
}

// A good edge before a failed one, then the newest session, then the most captures.
TEST(ReportCameras, TheEdgeThatSpeaksForACamera) {
  formats::RevisionInput revision = SampleReport().revision;
  const auto keep = [&](std::size_t edge, const std::string& name) {
    revision.edges[edge].evidence.push_back(
        {"", SensorId("front_left"), CaptureId(), Sha256Of(name), std::string(formats::kCameraFitSuffix)});
  };
  const auto chosen = [&](const std::map<SessionId, Stamp>& times) {
    return ChooseFits(revision, times).at(0).document;
  };
  keep(5, "failed");
  EXPECT_EQ(chosen({}), Sha256Of("failed"));
  keep(1, "few");
  EXPECT_EQ(chosen({}), Sha256Of("few"));
  keep(0, "many");
  EXPECT_EQ(chosen({}), Sha256Of("many"));
  const SessionId newer(Sha256Of("newer").str());
  revision.edges[1].session = newer;
  EXPECT_EQ(chosen({{newer, Stamp{5}}}), Sha256Of("few"));
}

TEST(ReportPictures, ALongListSaysHowManyAreShownAndWhereTheRestIs) {
  ReportInput input = SampleReport();
  Edge& edge = input.revision.edges[0];
  while (edge.evidence.size() < 40) edge.evidence.push_back(edge.evidence.front());
  edge.evidence.push_back({"", edge.frame_a, CaptureId(), Sha256Of("fit"), std::string(formats::kCameraFitSuffix)});
  const std::string page = PageOf(input);
  EXPECT_THAT(page, HasSubstr("24 of 40 pictures are shown."));
  EXPECT_THAT(page, HasSubstr("href=\"../../sessions/" + edge.session.str() + "/#captures\""));
}

}  // namespace
}  // namespace rigcal::report
