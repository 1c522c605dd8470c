#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "server/report/drawings/ring.h"
#include "tests/unit/report/sample.h"

namespace rigcal::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

formats::RevisionInput RingOf(int sensors) {
  formats::RevisionInput revision;
  revision.reference = SensorId("s0");
  for (int i = 0; i < sensors; ++i)
    AddPose(revision, "s" + std::to_string(i), true, SamplePose(i, 2 * i % 7, 0, 0), 0.01);
  for (int i = 0; i < sensors; ++i)
    revision.edges.push_back(SampleEdge("s" + std::to_string(i), "s" + std::to_string((i + 1) % sensors), Se3()));
  return revision;
}

TEST(GraphSvg, FailedEdgeIsDashedAndUnknownSensorGrey) {
  const std::string svg = RenderGraphSvg(SampleReport().revision);
  EXPECT_EQ(CountOf(svg, "<path class=\"link fit"), 5);
  EXPECT_EQ(CountOf(svg, "<path class=\"link failed\""), 1);
  EXPECT_EQ(CountOf(svg, "stroke-dasharray"), 1);
  EXPECT_EQ(CountOf(svg, "<circle class=\"node unknown\""), 1);
  EXPECT_EQ(CountOf(svg, "class=\"halo\""), 1);
  EXPECT_THAT(svg, HasSubstr("fill=\"#98a2b3\""));
  EXPECT_THAT(svg, HasSubstr(">tracker</text>"));
}

TEST(GraphSvg, AnEdgeThatNothingChecksIsNotShownAsAGoodFit) {
  formats::RevisionInput revision = SampleReport().revision;
  revision.solution.influences.judged = true;
  revision.solution.influences.edges = {
      {revision.solution.residuals[0].edge, false, 0.0, SensorId(), Vector6d::Zero()}};
  const std::string svg = RenderGraphSvg(revision);
  EXPECT_EQ(CountOf(svg, "<path class=\"link fit"), 4);
  EXPECT_EQ(CountOf(svg, "<path class=\"link unchecked\""), 1);
}

TEST(GraphSvg, OfAnEdgeThatIsCheckedInPartItSaysWhichPartIsNot) {
  formats::RevisionInput revision = SampleReport().revision;
  revision.basis.hardly_checked = {{revision.solution.residuals[0].edge, "the height is not checked by anything else"}};
  const std::string svg = RenderGraphSvg(revision);
  EXPECT_EQ(CountOf(svg, "<path class=\"link unchecked\""), 1);
  EXPECT_THAT(svg, testing::ContainsRegex("residual [^<]*; the height is not checked by anything else</title>"));
}

TEST(GraphSvg, EveryElementIsClosed) {
  const std::string svg = RenderGraphSvg(SampleReport().revision);
  for (const std::string tag : {"svg", "a", "path", "text", "circle", "title"}) {
    const std::regex open("<" + tag + "[ >][^>]*[^/]>|<" + tag + ">");
    const auto opened = std::distance(std::sregex_iterator(svg.begin(), svg.end(), open), std::sregex_iterator());
    EXPECT_EQ(opened, CountOf(svg, "</" + tag + ">")) << tag;
  }
}

TEST(GraphSvg, NamesUpToSixtySensors) {
  EXPECT_EQ(CountOf(RenderGraphSvg(RingOf(60)), "class=\"name"), 60);
  EXPECT_EQ(CountOf(RenderGraphSvg(RingOf(61)), "class=\"name"), 0);
  EXPECT_EQ(CountOf(RenderGraphSvg(RingOf(61)), "<circle class=\"node"), 61);
}

TEST(GraphSvg, AboveFourHundredSensorsAMapOfThreePaths) {
  const std::string svg = RenderGraphSvg(RingOf(401));
  EXPECT_EQ(CountOf(svg, "<circle"), 0);
  EXPECT_EQ(CountOf(svg, "<path"), 3);  // lines, dots, reference
  EXPECT_EQ(CountOf(svg, "h0"), 402);
}

TEST(GraphSvg, MapIsSeenAlongTheThinnestAxis) {
  formats::RevisionInput revision = RingOf(401);
  for (SensorPose& pose : revision.solution.poses) {
    pose.T_ref_sensor.p_m = {pose.T_ref_sensor.p_m.x(), 0.0, pose.T_ref_sensor.p_m.x() / 2};
  }
  ReportInput input = SampleReport();
  input.revision = revision;
  EXPECT_THAT(RenderRevision(input, "{}").value().at("index.html"),
              HasSubstr("x to the right, z upwards, seen along y"));
}

TEST(GraphSvg, MapHasNoUnknownSensorAndNoNan) {
  formats::RevisionInput revision = RingOf(401);
  for (SensorPose& pose : revision.solution.poses) pose.known = false;
  const std::string svg = RenderGraphSvg(revision);
  EXPECT_EQ(CountOf(svg, "<path"), 0);
  EXPECT_THAT(svg, Not(HasSubstr("known\"")));
}

TEST(GraphSvg, EmptyAndSingleSensor) {
  EXPECT_THAT(RenderGraphSvg(formats::RevisionInput()), HasSubstr("</svg>"));
  formats::RevisionInput one;
  AddPose(one, "only", true, Se3(), 0);
  one.reference = SensorId("only");
  EXPECT_EQ(CountOf(RenderGraphSvg(one), "<circle class=\"node reference\""), 1);
}

TEST(GraphSvg, EdgesOfOnePairBendApart) {
  const Curve first = CurveBetween({0, 0}, {100, 0}, 0, 2), second = CurveBetween({0, 0}, {100, 0}, 1, 2);
  EXPECT_GT((At(first, 0.5) - At(second, 0.5)).norm(), 20.0);
  EXPECT_NEAR(At(CurveBetween({0, 0}, {100, 0}, 0, 1), 0.5).y(), 0.0, 1e-12);
}

TEST(GraphSvg, TagsDoNotCoverEachOther) {
  TagPlaces places;
  const Curve curve = CurveBetween({0, 0}, {300, 0}, 0, 1);
  const auto first = places.Take(curve, {40, 16}), second = places.Take(curve, {40, 16});
  ASSERT_TRUE(first && second);
  EXPECT_GE(std::abs(first->x() - second->x()), 40.0);
  places.Block({150, 0}, {600, 100});
  EXPECT_FALSE(places.Take(curve, {40, 16}));
}

}  // namespace
}  // namespace rigcal::report
