// Causes of failed pairs on the page of a revision.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "server/report/edges/cause_groups.h"
#include "tests/unit/report/sample.h"

namespace rigcal::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Edge Failure(const std::string& a, const std::string& b) {
  Edge edge = SampleEdge(a, b, Se3());
  edge.state = EdgeState::kFailed;
  edge.diagnoses = {{"board_size_suspected", "The board looks larger before " + a + ".", "Measure it."}};
  return edge;
}

Cause LargePanel(const std::vector<Edge>& edges) {
  Cause cause;
  cause.kind = "board_size";
  cause.key = "board_size panel larger";
  cause.boards = {TargetId("panel")};
  for (const Edge& edge : edges) cause.edges.push_back(edge.id);
  cause.why = "The squares of board panel are probably 92.70 mm, not 90.00 mm.";
  cause.what_to_do = "Measure one with a caliper and correct session.yaml.";
  cause.command = "rigcal push FOLDER";
  return cause;
}

// Two failures of one cause beside the one of the sample, which no cause explains.
ReportInput WithPanel() {
  ReportInput input = SampleReport();
  const std::vector<Edge> failed = {Failure("top", "lidar"), Failure("front_left", "top")};
  input.revision.edges.insert(input.revision.edges.end(), failed.begin(), failed.end());
  input.revision.causes = {LargePanel(failed)};
  return input;
}

TEST(ReportCauses, StandBelowTheBannerEachWithACommandAndItsEdges) {
  const ReportInput input = WithPanel();
  const std::string page = PageOf(input), list = Between(page, "id=\"causes\"", "</section>");
  EXPECT_LT(page.find("aria-label=\"Verdict\""), page.find("id=\"causes\""));
  EXPECT_LT(page.find("aria-label=\"Key figures\""), page.find("id=\"causes\""));  // the verdict has named the worst
  EXPECT_THAT(list, HasSubstr("The squares of board panel are probably 92.70 mm"));
  EXPECT_THAT(list, HasSubstr("Measure one with a caliper and correct session.yaml. Then:"));
  EXPECT_THAT(list, HasSubstr("<pre class=\"command\"><code>rigcal push FOLDER</code></pre>"));
  EXPECT_THAT(list, HasSubstr("Explains 2 failed pairs"));
  for (const EdgeId& edge : input.revision.causes[0].edges)
    EXPECT_THAT(list, HasSubstr("href=\"#e-" + edge.str().substr(0, 16) + "\""));
}

TEST(ReportCauses, LinksLeadSomewhere) {
  const std::string page = PageOf(WithPanel());
  const std::regex link("href=\"#([^\"]+)\"");
  for (std::sregex_iterator it(page.begin(), page.end(), link), end; it != end; ++it)
    EXPECT_EQ(CountOf(page, "id=\"" + (*it)[1].str() + "\""), 1) << (*it)[1];
}

TEST(ReportCauses, WithoutAnyThePageIsAsBefore) {
  const std::string page = PageOf(SampleReport());
  EXPECT_THAT(page, Not(HasSubstr("id=\"causes\"")));
  EXPECT_THAT(page, Not(HasSubstr("Which pairs")));
}

TEST(ReportCauses, OneThatFailedNoPairHasNeitherEdgesNorCommand) {
  ReportInput input = SampleReport();
  Cause cause;
  cause.why = "No session measured tracker.";
  cause.what_to_do = "Capture tracker together with a known sensor.";
  input.revision.causes = {cause};
  const std::string list = Between(PageOf(input), "id=\"causes\"", "</section>");
  EXPECT_THAT(list, HasSubstr("together with a known sensor.</p>"));
  EXPECT_THAT(list, Not(HasSubstr("Explains")));
  EXPECT_THAT(list, Not(HasSubstr("<pre")));
}

TEST(ReportCauses, TheEdgesOfOneAreARowOfTheTable) {
  const std::string table = Between(PageOf(WithPanel()), "<table class=\"edges\"", "</table>");
  EXPECT_EQ(CountOf(table, "The squares of board panel"), 1);
  EXPECT_THAT(table, HasSubstr(">2 pairs</a></th>"));
  EXPECT_THAT(table, Not(HasSubstr("The board looks larger before")));
  EXPECT_THAT(table, HasSubstr("front_left &rarr; top"));
  EXPECT_THAT(table, HasSubstr("Only 2 of 9 captures show the board")) << "no cause explains it";
  EXPECT_LT(table.find(">2 pairs<"), table.find("front_left &rarr; rear"));
}

TEST(ReportCauses, TheEdgesOfOneAreAClosedFoldOfTheirOwn) {
  const std::string page = PageOf(WithPanel());
  const std::string fold = Between(page, "<details class=\"card edge failed group\">", "</summary>");
  EXPECT_THAT(fold, HasSubstr("<span class=\"badge fail\">2 pairs</span>"));
  EXPECT_THAT(fold, HasSubstr("The squares of board panel"));
  const std::string inner = Between(page, "<details class=\"card edge failed group\">", "front_left &rarr; rear</h2>");
  EXPECT_EQ(CountOf(inner, "The board looks larger before"), 2);
  EXPECT_THAT(page, HasSubstr("<details class=\"card edge failed\" open>")) << "no cause explains it";
}

TEST(ReportCauses, AnEdgeAloneIsShownAsItself) {
  ReportInput input = WithPanel();
  input.revision.causes[0].edges.resize(1);
  const std::string page = PageOf(input);
  EXPECT_THAT(page, HasSubstr("Explains 1 failed pair<"));
  EXPECT_THAT(page, Not(HasSubstr("Which pairs")));
  EXPECT_THAT(page, Not(HasSubstr("failed group")));
}

TEST(GroupByCause, AnOlderFailureOfAPairStandsWithItsNewest) {
  ReportInput input = WithPanel();
  Edge older = Failure("lidar", "top");
  older.id = EdgeId(Sha256Of("older").str());
  input.revision.edges.push_back(older);
  const auto shown = InOrder(input.revision);
  const EdgesByCause edges = GroupByCause(input.revision, shown);
  ASSERT_EQ(edges.groups.size(), 1u);
  EXPECT_EQ(edges.groups[0].edges.size(), 3u);
  EXPECT_EQ(edges.groups[0].pairs, 2u);
  EXPECT_EQ(edges.groups[0].edges.size() + edges.others.size(), shown.size());
}

TEST(GroupByCause, AnEdgeOfTwoCausesStandsWithTheFirst) {
  ReportInput input = WithPanel();
  input.revision.causes.push_back(input.revision.causes[0]);
  const auto shown = InOrder(input.revision);
  const EdgesByCause edges = GroupByCause(input.revision, shown);
  ASSERT_EQ(edges.groups.size(), 1u);
  EXPECT_EQ(edges.groups[0].cause, &input.revision.causes[0]);
}

TEST(ReportCauses, WhatIsTooLongIsNamed) {
  ReportInput input = SampleReport();
  std::vector<Edge> failed;
  for (int i = 0; i < 250; ++i) failed.push_back(Failure("camera_" + std::to_string(i), "lidar"));
  input.revision.edges.insert(input.revision.edges.end(), failed.begin(), failed.end());
  input.revision.causes = {LargePanel(failed)};
  const std::string page = PageOf(input);
  EXPECT_THAT(page, HasSubstr("Explains 250 failed pairs"));
  EXPECT_THAT(page, HasSubstr("50 more are in <a href=\"edges.csv\">"));
}

// Whoever opens no fold reads that something is in them.
TEST(ReportCauses, TheHeadingOfAllEdgesCountsThoseWithWarnings) {
  ReportInput input = SampleReport();
  input.revision.edges[0].diagnoses = {{"few_captures", "Only 8 captures.", "Take more."}};
  EXPECT_THAT(Between(PageOf(input), "id=\"details\"", "</h2>"), HasSubstr("2 of 3 have warnings"));
  input.revision.edges[0].diagnoses.clear();
  EXPECT_THAT(Between(PageOf(input), "id=\"details\"", "</h2>"), HasSubstr("1 of 3 has warnings"));
}

}  // namespace
}  // namespace rigcal::report
