// Maps over a camera's picture: what they draw, what they say to those who do not see them, and that they stay small.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/model/sensors/coverage.h"
#include "server/report/cameras/field_map.h"
#include "tests/unit/report/sample.h"

namespace rigcal::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::size_t kMapBytesMax = 20'000;

// 1200 x 900 in fields of 12 x 9, each 0.05 px but for the one at the upper left.
FieldMap SmallMap() {
  FieldMap map{1200, 900, 12, 9, std::vector<std::optional<double>>(108, 0.05), std::vector<bool>(108, true)};
  map.value_px[0] = 4.2;
  map.value_px[1] = std::nullopt;
  map.seen[0] = false;
  return map;
}

std::string Drawn(const FieldMap& map) {
  Dictionary page("camera");
  Dictionary* one = page.AddSectionDictionary("UNCERTAINTY")->AddSectionDictionary("MAP");
  FillFieldMap(*one, map, "what it says");
  const std::string text = Expand("camera.tpl", page).value();
  const auto from = text.find("<svg class=\"map picture\" viewBox=\"0 0 360 270\"");
  return from == std::string::npos ? "" : text.substr(from, text.find("</figure>", from) - from);
}

TEST(FieldMapDrawing, NeighboursAreOnePieceAndUnseenFieldsHatched) {
  const std::string svg = Drawn(SmallMap());
  EXPECT_THAT(svg, HasSubstr("<path class=\"heat5\" d=\"M0 0h1v1h-1z\"/>"));
  EXPECT_THAT(svg, HasSubstr("<path class=\"heat1\" d=\"M2 0h10v1h-10zM0 1h12v1h-12z"));
  EXPECT_THAT(svg, HasSubstr("<path class=\"unseen\" d=\"M0 0m0 1l1-1\"/>"));
  EXPECT_THAT(svg, Not(HasSubstr("class=\"heat2\" d")));
  EXPECT_THAT(svg, HasSubstr("role=\"img\" aria-label=\"what it says\""));
  EXPECT_THAT(svg, HasSubstr("blank: no ray"));
  EXPECT_THAT(svg, Not(HasSubstr("class=\"shift\"")));
}

TEST(FieldMapDrawing, EachClassBeginsWhereTheScaleSays) {
  FieldMap map = SmallMap();
  map.columns = 6, map.rows = 1;
  map.value_px = {0.0999, 0.1, 0.3, 1.0, 2.999, 3.0};
  map.seen.assign(6, true);
  const std::string svg = Drawn(map);
  for (const char* part : {"heat1\" d=\"M0 0h1v1h-1z\"", "heat2\" d=\"M1 0h1v1h-1z\"", "heat3\" d=\"M2 0h1v1h-1z\"",
                           "heat4\" d=\"M3 0h2v1h-2z\"", "heat5\" d=\"M5 0h1v1h-1z\"", "heat5\">3 and more"})
    EXPECT_THAT(svg, HasSubstr(part));
  EXPECT_THAT(svg, Not(HasSubstr("unseen")));
}

// A field is 30 units wide: the longest arrow of 0.4 px, 0.12 units long, becomes 24 when it is 200 times as long.
TEST(FieldMapDrawing, ArrowsLeadFromTheMiddleOfTheirFields) {
  FieldMap map = SmallMap();
  map.arrow_px.assign(108, Eigen::Vector2d(0.0, 0.0));
  map.arrow_px[13] = Eigen::Vector2d(0.0, -0.4);
  map.arrow_px[14] = std::nullopt;
  const std::string svg = Drawn(map);
  EXPECT_THAT(svg, HasSubstr("<path class=\"shift\" d=\"M45.0 45.0l0.0 -24.0\"/>"));
  EXPECT_THAT(svg, HasSubstr("which way, 200 times as long"));
  map.arrow_px[13] = Eigen::Vector2d(0.0, 0.0);
  EXPECT_THAT(Drawn(map), Not(HasSubstr("class=\"shift\""))) << "nothing moved";
}

TEST(FieldMapDrawing, PlacesAreNamed) {
  FieldMap map = SmallMap();
  const auto where = [&](std::size_t field) {
    map.value_px.assign(108, 0.0);
    map.value_px[field] = 1.0;
    return WorstOf(map)->where;
  };
  EXPECT_EQ(where(0), "at the upper left");
  EXPECT_EQ(where(6), "at the top");
  EXPECT_EQ(where(11), "at the upper right");
  EXPECT_EQ(where(4 * 12), "at the left");
  EXPECT_EQ(where(4 * 12 + 6), "in the middle");
  EXPECT_EQ(where(4 * 12 + 11), "at the right");
  EXPECT_EQ(where(8 * 12), "at the lower left");
  EXPECT_EQ(where(8 * 12 + 5), "at the bottom");
  EXPECT_EQ(where(107), "at the lower right");
  map.value_px.assign(108, std::nullopt);
  EXPECT_FALSE(WorstOf(map));
}

TEST(FieldMapDrawing, StaysSmallWhateverIsInIt) {
  FieldMap map{900, 1800, 12, 24, {}, std::vector<bool>(288, false)};
  for (int field = 0; field < 288; ++field) {
    map.value_px.emplace_back(field % 2 == 0 ? 0.05 : 5.0);
    map.arrow_px.emplace_back(Eigen::Vector2d(-11.11, 17.77) * (1 + field % 3));
  }
  Dictionary page("camera");
  FillFieldMap(*page.AddSectionDictionary("UNCERTAINTY")->AddSectionDictionary("MAP"), map, "");
  Dictionary empty("camera");
  const std::size_t bytes = Expand("camera.tpl", page)->size() - Expand("camera.tpl", empty)->size();
  EXPECT_LT(bytes, kMapBytesMax);
  EXPECT_GT(bytes, 5'000U) << "it is there";
}

CameraReport Front() {
  CameraReport camera;
  camera.fit.camera = SensorId("front_left");
  camera.fit.width_px = 1200, camera.fit.height_px = 900;
  camera.fit.source = IntrinsicsSource::kEstimated;
  camera.fit.intrinsics = {700, 700, 599.5, 449.5, {-0.1, 0.02, 0.0, 0.001, 0.0}};
  camera.fit.sigma.assign(9, 0.1);
  camera.fit.views.resize(1);
  camera.fit.views[0].capture = CaptureId("01");
  for (int row = 0; row < 9; ++row)
    for (int column = 1; column < 12; ++column)
      camera.fit.views[0].uv_px.emplace_back(MiddleOf(column, 1200, 12), MiddleOf(row, 900, 9));
  camera.edge = SampleReport().revision.edges[0].id;
  camera.document = Sha256Of("fit");
  camera.uncertainty = ProjectionUncertainty{12, 9, std::vector<PointSigma>(108, {0.05, 0.04}), {0.021, 0.017}};
  camera.uncertainty->fields[12 * 8] = {5.6, 5.4};
  camera.uncertainty->fields[11] = {0.86, 0.7};
  return camera;
}

std::string CameraPageOf(const CameraReport& camera) {
  ReportInput input = SampleReport();
  input.sensors[SensorId("front_left")] = {};
  input.cameras = {camera};
  return RenderRevision(input, "{}").value().at("index.html");
}

TEST(UncertaintySection, TellsMiddleAndWorstInWordsAndToThoseWhoDoNotSee) {
  const std::string page = CameraPageOf(Front());
  EXPECT_THAT(page,
              HasSubstr("<strong>A point far away</strong> 0.021 px in the middle, at most 5.6 px (at the lower left); "
                        "where corners were seen, at most 0.86 px"));
  EXPECT_THAT(
      page, HasSubstr("<strong>A point 2 m away</strong> 0.017 px in the middle, at most 5.4 px (at the lower left)"));
  EXPECT_THAT(page, HasSubstr("aria-label=\"Standard deviation of where a point 2 m away is projected, by fields of "
                              "the picture: 0.017 px"));
  EXPECT_THAT(page, HasSubstr("No corners were seen in the hatched fields."));
  EXPECT_THAT(page, HasSubstr("hold the board there in the next session"));
}

TEST(UncertaintySection, WithoutHatchedFieldsNobodyIsSentThere) {
  CameraReport camera = Front();
  for (int row = 0; row < 9; ++row)
    camera.fit.views[0].uv_px.emplace_back(MiddleOf(0, 1200, 12), MiddleOf(row, 900, 9));
  const std::string page = CameraPageOf(camera);
  EXPECT_THAT(page, HasSubstr("How certain projections are"));
  EXPECT_THAT(page, Not(HasSubstr("hold the board there")));
  EXPECT_THAT(page, Not(HasSubstr("where corners were seen, at most")));
}

TEST(UncertaintySection, SaysWhyThereIsNoMap) {
  CameraReport camera = Front();
  camera.uncertainty.reset();
  EXPECT_THAT(CameraPageOf(camera), HasSubstr("did not keep the covariance"));
  camera.fit.sigma.clear();
  EXPECT_THAT(CameraPageOf(camera), HasSubstr("leave a value of the intrinsics open"));
  camera.fit.source = IntrinsicsSource::kGiven;
  EXPECT_THAT(CameraPageOf(camera), HasSubstr("were given in session.yaml without a covariance"));
  camera.fit.sigma.assign(9, 0.0);
  EXPECT_THAT(CameraPageOf(camera), HasSubstr("given in session.yaml as exact"));
  camera.fit.source = IntrinsicsSource::kNone;
  EXPECT_THAT(CameraPageOf(camera), Not(HasSubstr("How certain projections are")));
}

TEST(UncertaintySection, TheWholeOfACameraCostsLittle) {
  CameraReport without = Front();
  without.uncertainty.reset();
  EXPECT_LT(CameraPageOf(Front()).size() - CameraPageOf(without).size(), kMapBytesMax);
}

}  // namespace
}  // namespace rigcal::report
