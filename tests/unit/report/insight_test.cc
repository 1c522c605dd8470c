#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <sstream>

#include "tests/unit/report/sample.h"

namespace rigcal::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

CycleResidual Loop(const std::vector<std::string>& sensors, double t_squared, double limit) {
  CycleResidual cycle;
  for (const std::string& sensor : sensors) cycle.sensors.emplace_back(sensor);
  cycle.e << 0.012, 0.0, 0.016, 0.0, 0.0349065850398866, 0.0;  // 20 mm, 2 degrees
  cycle.tested = limit > 0.0;
  cycle.t_squared = t_squared, cycle.limit = limit;
  return cycle;
}

TEST(ReportEdges, BesideAResidualTheTableSaysWhatOfItsEdgeIsNotChecked) {
  ReportInput input = SampleReport();
  input.revision.basis.hardly_checked = {
      {input.revision.solution.residuals[0].edge, "the height is not checked by anything else"}};
  const std::string page = PageOf(input);
  EXPECT_THAT(page,
              testing::ContainsRegex("<span class=\"soft in-part\">the height is not checked by anything else</span>"
                                     "</td><td><span class=\"badge unchecked\">"));
}

TEST(ReportLoops, WorstFirstAndFailingOnesMarked) {
  ReportInput input = SampleReport();
  Cycles& cycles = input.revision.solution.cycles;
  cycles.judged = true;
  cycles.examined = 9, cycles.tested = 8, cycles.failing = 1;
  cycles.worst = {Loop({"front_left", "lidar", "rear"}, 91.0, 36.1), Loop({"front_left", "lidar"}, 9.0, 36.1),
                  Loop({"rear", "top"}, 0.0, 0.0)};
  const std::string page = PageOf(input);
  EXPECT_THAT(page, HasSubstr("9 loops worked out, 8 tested: 1 does not close."));
  EXPECT_THAT(page, HasSubstr("Shown are the 3 that close worst"));
  EXPECT_THAT(
      page,
      HasSubstr("<tr><th scope=\"row\">front_left \xE2\x86\x92 lidar \xE2\x86\x92 rear \xE2\x86\x92 front_left</th>"
                "<td>20.0</td><td>2.00</td><td><span class=\"beyond\">91.0 (36.1)</span></td>"
                "<td class=\"text\"><span class=\"badge fail\">does not close</span></td></tr>"));
  EXPECT_THAT(page, HasSubstr("<td><span>9.00 (36.1)</span></td><td class=\"text\"><span class=\"badge pass\">closes"));
  EXPECT_THAT(page, HasSubstr("its edges share their errors, so it closes whatever they are"));
  cycles.worst.back().edges = {input.revision.edges[0].id, input.revision.edges[1].id};
  input.revision.edges[1].uncertainty.rank = 5;
  EXPECT_THAT(PageOf(input), HasSubstr("no direction is seen by all of its edges"));
}

TEST(ReportLoops, SaysWhatIsMissing) {
  ReportInput input = SampleReport();
  EXPECT_THAT(PageOf(input), Not(HasSubstr("id=\"loops\"")));  // a revision of before
  input.revision.solution.cycles.why_not = "Loops were left out: too many sensors.";
  EXPECT_THAT(PageOf(input), HasSubstr("Loops were left out: too many sensors."));
  input.revision.solution.cycles = Cycles();
  input.revision.solution.cycles.judged = true;
  EXPECT_THAT(PageOf(input), HasSubstr("There is no loop of edges: nothing checks them."));
}

TEST(ReportLoops, ALongLoopIsCut) {
  ReportInput input = SampleReport();
  input.revision.solution.cycles.judged = true;
  input.revision.solution.cycles.worst = {Loop(std::vector<std::string>(40, "one"), 9.0, 36.1)};
  EXPECT_THAT(PageOf(input), HasSubstr("\xE2\x80\xA6 (40 edges)"));
}

TEST(ReportInfluenceColumn, WhatTheSolutionWithoutTheEdgeWouldBe) {
  ReportInput input = SampleReport();
  Influences& influences = input.revision.solution.influences;
  influences.judged = true;
  EdgeInfluence moved{input.revision.edges[0].id, true, 9.0, SensorId("rear"), Vector6d::Zero(), 4.25};
  moved.move << 0.0, 0.003, 0.004, 0.0349065850398866, 0.0, 0.0;
  influences.edges = {moved, {input.revision.edges[1].id, false, 0.0, SensorId(), Vector6d::Zero(), 0.0}};
  std::sort(influences.edges.begin(), influences.edges.end(),
            [](const auto& a, const auto& b) { return a.edge < b.edge; });
  const std::string page = PageOf(input);
  EXPECT_THAT(page, HasSubstr("<td data-v=\"4.25\">5.0 / 2.0 / 4.25<br><span class=\"soft\">rear</span></td>"));
  EXPECT_THAT(page, HasSubstr("<td data-v=\"\" class=\"soft\">nothing checks it</td>"));
  std::map<std::string, std::string> last;  // columns of edges.csv, by edge
  input.blocks[moved.edge] = {{"07", 1e-3 * Vector6d::Unit(tangent::kX)}, {"03", 1e-3 * Vector6d::Unit(tangent::kRx)}};
  const auto endings = [&] {
    std::istringstream csv(RenderRevision(input, "{}").value().at("edges.csv"));
    for (std::string line; std::getline(csv, line);)
      for (const Edge& edge : input.revision.edges)
        if (const auto at = line.find(edge.id.str()); at != std::string::npos)
          last[edge.id.str()] = line.substr(line.find(',', at + 65));
    return last;
  };
  EXPECT_EQ(endings()[moved.edge.str()], ",yes,rear,0.005,0.034906585,4.25,07,0.001\r");
  EXPECT_EQ(endings()[input.revision.edges[1].id.str()], ",no,,,,,,\r");
  EXPECT_EQ(endings()[input.revision.edges[2].id.str()], ",,,,,,,\r");
  influences.edges.clear();
  influences.judged = false;
  influences.why_not = "Influence was left out: too many sensors.";
  EXPECT_THAT(PageOf(input), HasSubstr("Influence was left out: too many sensors."));
}

}  // namespace
}  // namespace rigcal::report
