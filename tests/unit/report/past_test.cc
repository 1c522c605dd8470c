// Edges that were good and do not count any more are neither failures nor measurements.
#include "server/model/edges/past.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/report/edges/page_data.h"
#include "server/report/text/changes.h"
#include "server/report/text/unknown.h"
#include "tests/unit/report/sample.h"

namespace rigcal::report {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

void MakePast(Edge& edge, const char* code) {
  edge.state = EdgeState::kFailed;
  edge.diagnoses = {{code, "its session was pushed again", "Nothing."}};
}

// Four good edges and one of the past, which was the pair's first; none failed.
ReportInput OnePast(const char* code) {
  ReportInput input = SampleReport();
  input.revision.edges.pop_back();
  Edge old = SampleEdge("front_left", "front_right", Se3());
  old.id = EdgeId(Sha256Of("old").str());
  input.revision.edges.insert(input.revision.edges.begin(), old);
  input.previous = PastRevision{6, input.revision};
  MakePast(input.revision.edges.front(), code);
  return input;
}

TEST(ReportPast, APastEdgeIsNoFailure) {
  for (const char* code : {"superseded", "remounted", "epoch", "retired", "sensor_retired"}) {
    const ReportInput input = OnePast(code);
    const std::string page = RenderRevision(input, "{}").value().at("index.html");
    EXPECT_THAT(page, HasSubstr("5 good, 0 failed, 1 past"));
    EXPECT_THAT(page, HasSubstr("<span class=\"badge unknown\">past</span>"));
    EXPECT_THAT(page, Not(HasSubstr("<span class=\"badge fail\">failed</span>")));
    EXPECT_THAT(page, HasSubstr("1 edge does not count any more: front_left \xE2\x86\x92 front_right."));
    EXPECT_THAT(page, HasSubstr("5 edges\""));  // of the drawing
    EXPECT_THAT(page, HasSubstr("1 past edge is not drawn."));
    EXPECT_EQ(InOrder(input.revision).back().edge, &input.revision.edges.front());
    EXPECT_THAT(EdgeCsv(input, InOrder(input.revision)), HasSubstr("front_left,front_right,past,stereo"));
  }
}

TEST(ReportPast, AnyOtherReasonIsAFailure) {
  const std::string page = RenderRevision(OnePast("too_few_captures"), "{}").value().at("index.html");
  EXPECT_THAT(page, AllOf(HasSubstr("5 good, 1 failed"), Not(HasSubstr("past edge")), Not(HasSubstr("any more"))));
  EXPECT_FALSE(IsPast(SampleEdge("a", "b", Se3())));
}

TEST(ReportPast, AnEdgeOfAnEarlierVisitIsLinkedToThatVisitsReport) {
  ReportInput input = SampleReport();
  const Edge& edge = input.revision.edges.front();
  ASSERT_FALSE(WorthDetails(input).contains(edge.id));
  const std::string anchor = "e-" + edge.id.str().substr(0, 16), section = "<div id=\"" + anchor + "\"";
  EXPECT_THAT(RenderRevision(input, "{}").value().at("index.html"), HasSubstr(section));
  input.detailed_in[edge.id] = 3;
  const auto files = RenderRevision(input, "{}").value();
  EXPECT_THAT(files.at("index.html"), AllOf(HasSubstr("<a href=\"../3/#" + anchor + "\">"), Not(HasSubstr(section)),
                                            HasSubstr("1 edge of earlier visits")));
  EXPECT_THAT(files.at("data.js"), Not(HasSubstr(anchor)));
  EXPECT_THAT(files.at("edges.csv"), HasSubstr(edge.frame_a.str() + "," + edge.frame_b.str()));
}

TEST(ReportPast, WhatFailsOrContradictsIsWorthAnotherLook) {
  ReportInput input = SampleReport();
  const EdgeId beyond = input.revision.edges[0].id, within = input.revision.edges[1].id;
  input.limits = {{beyond, {30.0, 20.0}}, {within, {10.0, 20.0}}};
  const std::set<EdgeId> worth = WorthDetails(input);
  EXPECT_TRUE(worth.contains(beyond));
  EXPECT_FALSE(worth.contains(within));
  for (const Edge& edge : input.revision.edges)
    EXPECT_TRUE(edge.state != EdgeState::kFailed || worth.contains(edge.id));
}

TEST(ReportPast, ChangesNameWhatBecamePast) {
  const ReportInput input = OnePast("remounted");
  const auto& edges = input.revision.edges;
  EXPECT_THAT(Compare(input.previous->revision, input.revision).edges_past, ElementsAre(&edges.front()));
  EXPECT_TRUE(Compare(input.revision, input.revision).edges_past.empty());  // it was past before
}

// A visit from before a remount, pushed after it.
TEST(ReportPast, WhatIsNewAndPastIsCalledSo) {
  ReportInput input = OnePast("remounted");
  auto& before = input.previous->revision.edges;
  before.erase(before.begin());
  const std::string page = RenderRevision(input, "{}").value().at("index.html");
  EXPECT_THAT(page, HasSubstr("1 edge new: front_left \xE2\x86\x92 front_right (past)."));
  EXPECT_THAT(page, Not(HasSubstr("any more")));
}

TEST(ReportPast, ASensorThatOnlyPastEdgesReachSaysSo) {
  ReportInput input = SampleReport();
  Edge old = SampleEdge("front_left", "tracker", Se3());
  MakePast(old, "remounted");
  input.revision.edges.push_back(old);
  EXPECT_EQ(WhyUnknown(input.revision).at(SensorId("tracker")), "its edges do not count any more: front_left");
}

TEST(ReportPast, ARetiredSensorIsNamedWithTheWayBackAndIsNoLoss) {
  ReportInput input = SampleReport();
  input.previous = PastRevision{6, input.revision};
  const SensorId gone("top");
  std::erase_if(input.revision.solution.poses, [&](const SensorPose& pose) { return pose.sensor == gone; });
  Edge& its = input.revision.edges[4];
  ASSERT_EQ(its.frame_b, gone);
  std::erase_if(input.revision.solution.residuals,
                [&](const EdgeResidual& residual) { return residual.edge == its.id; });
  MakePast(its, "sensor_retired");
  input.revision.retired = {{gone, {*ParseIso("2026-01-31T12:00:00Z"), "Ada <b>", "taken off."}}};
  EXPECT_THAT(Compare(input.previous->revision, input.revision).sensors_retired, ElementsAre(gone));
  EXPECT_TRUE(Compare(input.previous->revision, input.revision).sensors_lost.empty());
  EXPECT_TRUE(Compare(input.revision, input.revision).sensors_retired.empty());
  const std::string page = RenderRevision(input, "{}").value().at("index.html");
  EXPECT_THAT(page, HasSubstr(gone.str() +
                              " was retired on 2026-01-31 by Ada &lt;b&gt;: taken off. To bring it back: "
                              "<code class=\"typed\">rigcal restore " +
                              gone.str() + " --robot "));
  EXPECT_THAT(page, HasSubstr("Retired: " + gone.str() + "."));
  EXPECT_THAT(page, Not(HasSubstr("No longer known")));
}

}  // namespace
}  // namespace rigcal::report
