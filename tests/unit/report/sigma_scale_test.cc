// One scale for figures in sigmas, wherever they stand: the cases are those of tests/browser/sigma_scale_test.cjs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "server/report/robot_pages.h"
#include "server/report/text/sigmas.h"
#include "tests/unit/report/sample.h"

namespace rigcal::report {
namespace {

using ::testing::HasSubstr;

struct Case {
  double in_sigmas;
  std::string name, text;
};

const std::vector<Case>& Cases() {
  static const std::vector<Case> cases = {{0.0, "fit0", "0.0"},   {0.99, "fit0", "1.0"},    {1.0, "fit1", "1.0"},
                                          {1.99, "fit1", "2.0"},  {2.0, "fit2", "2.0"},     {2.5, "fit2", "2.5"},
                                          {2.66, "fit2", "2.7"},  {2.99, "fit2", "2.9"},    {3.0, "fit3", "3.0"},
                                          {24.9, "fit3", "24.9"}, {118.68, "fit3", "118.7"}};
  return cases;
}

// Of every edge as far off as said.
ReportInput AllOffBy(double in_sigmas) {
  ReportInput input = SampleReport();
  std::erase_if(input.revision.edges, [](const Edge& edge) { return edge.state == EdgeState::kFailed; });
  for (EdgeResidual& residual : input.revision.solution.residuals) {
    const auto edge = std::find_if(input.revision.edges.begin(), input.revision.edges.end(),
                                   [&](const Edge& one) { return one.id == residual.edge; });
    residual.by_jackknife = false;
    residual.weighted = in_sigmas * in_sigmas * edge->uncertainty.rank * (1.0 + 1e-12);
  }
  return input;
}

std::string FleetPageOff(double in_sigmas) {
  RobotSummary robot;
  robot.robot = RobotId("mapper-01");
  robot.worst = WorstEdge{SensorId("left"), SensorId("mast"), in_sigmas};
  FleetCounts fleet;
  fleet.robots = 1;
  return RenderFleet(fleet, {{robot}, 1, 1, 1}, Stamp{0}, {}, 0).value();
}

TEST(SigmaScale, LimitsAndTexts) {
  for (const Case& one : Cases()) {
    EXPECT_EQ(SigmasClass(one.in_sigmas), one.name) << one.in_sigmas;
    EXPECT_EQ(SigmasText(one.in_sigmas), one.text);
  }
  EXPECT_STREQ(SigmasClass(std::numeric_limits<double>::quiet_NaN()), "fit3");
}

// What is amber in the list of robots is amber on the robot's report: its key figure, its drawing and its table.
TEST(SigmaScale, TheSameFigureHasTheSameColourOnEveryPage) {
  for (const Case& one : Cases()) {
    EXPECT_THAT(FleetPageOff(one.in_sigmas),
                HasSubstr("<span class=\"badge " + one.name + "\">" + one.text + " &sigma;"));
    if (one.in_sigmas == 0.0) continue;
    const std::string page = RenderRevision(AllOffBy(one.in_sigmas), "{}").value().at("index.html");
    EXPECT_THAT(page, HasSubstr("<div class=\"card figure " + one.name + "\"><h2>Worst edge</h2>")) << one.in_sigmas;
    EXPECT_THAT(page, HasSubstr("<path class=\"link " + one.name + "\"")) << one.in_sigmas;
    EXPECT_THAT(page, HasSubstr("<td><span class=\"badge " + one.name + "\">")) << one.in_sigmas;
  }
}

}  // namespace
}  // namespace rigcal::report
