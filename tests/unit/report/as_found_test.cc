// "As found, as left" on the page of a revision.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/unit/report/sample.h"

namespace rigcal::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string Section(const ReportInput& input) {
  const std::string page = PageOf(input);
  const auto from = page.find("<h2 id=\"found\"");
  return from == std::string::npos ? "" : page.substr(from, page.find("</section>", from) - from);
}

AsFound OneDrifted() {
  AsFound found;
  found.session = SessionId(std::string(64, 'c'));
  found.in_use = 6;
  found.tests = 6;
  found.relative_to = SensorId("front_left");
  found.text = "As found (session of 2026-11-03, against revision 6): front_right moved 1.2 mm, 0.04 deg (12 sigma).";
  SensorFound right, rear;
  right.sensor = SensorId("front_right");
  right.state = FoundState::kDrifted;
  right.axes.fill(FoundState::kUnchanged);
  right.axes[0] = FoundState::kDrifted;
  right.axes[5] = FoundState::kNotMeasured;
  right.change << 1.2e-3, 0, -5e-5, 1e-3, 0, 0;
  right.sigma << 1e-4, 1e-4, 1e-4, 2e-3, 2e-3, 0;
  right.smallest << 6.4e-4, 6.4e-4, 6.4e-4, std::numeric_limits<double>::infinity(), 0.02, 0;
  right.left = (Vector6d() << 2.5e-4, 4e-4, 0, 0, 0, 0).finished();
  rear.sensor = SensorId("rear");
  rear.state = FoundState::kMovedOnPurpose;
  found.sensors = {right, rear};
  return found;
}

TEST(AsFoundSection, HasARowPerAxisBeforeAndAfter) {
  ReportInput input = SampleReport();
  EXPECT_EQ(Section(input), "");
  input.as_found = OneDrifted();
  const std::string section = Section(input);
  EXPECT_THAT(section, HasSubstr(input.as_found->text));
  EXPECT_THAT(section, HasSubstr("href=\"../../sessions/" + std::string(64, 'c')));
  EXPECT_THAT(
      section,
      HasSubstr("<bdi>front_right</bdi><br><span class=\"badge warn\">drifted</span></th><td class=\"text\">x</td>"
                "<td>1.20 mm</td><td><span class=\"badge fit3\">12.0</span></td><td>0.25 mm</td><td><span "
                "class=\"badge fit2\">2.5</span>"
                "</td><td class=\"sigma\">0.10 mm</td><td>0.64 mm</td></tr>"));
  EXPECT_THAT(section, HasSubstr("<td>0.40 mm</td><td>4.0</td>")) << "only what drifted has a colour";
  EXPECT_THAT(section, HasSubstr("<td class=\"text\">z</td><td>-0.05 mm</td><td>0.5</td>"));
  EXPECT_THAT(section, HasSubstr("<td class=\"sigma\">0.11 deg</td><td>any may stay unseen</td>"));
  EXPECT_THAT(section, HasSubstr("<td class=\"text\">rz</td><td class=\"text soft\" colspan=\"6\">not measured</td>"));
  EXPECT_THAT(section, HasSubstr("<bdi>rear</bdi><br><span class=\"badge unknown\">moved on purpose</span>"));
  EXPECT_THAT(section, HasSubstr("Seen from <bdi>front_left</bdi>"));
  EXPECT_THAT(section, HasSubstr("odds of 0.10 %"));
  EXPECT_THAT(section, Not(HasSubstr("30 days")));
}

TEST(AsFoundSection, NobodyPassesOfWhomNoChangeCouldBeTold) {
  ReportInput input = SampleReport();
  input.as_found = OneDrifted();
  SensorFound& right = input.as_found->sensors[0];
  right.state = right.axes[0] = FoundState::kUnchanged;
  EXPECT_THAT(Section(input), HasSubstr("<bdi>front_right</bdi><br><span class=\"badge unknown\">cannot tell</span>"));
  right.smallest(3) = 0.02;
  EXPECT_THAT(Section(input), HasSubstr("<bdi>front_right</bdi><br><span class=\"badge pass\">unchanged</span>"));
}

TEST(AsFoundSection, NobodyPassesWhoIsNotToldApartFromScatter) {
  ReportInput input = SampleReport();
  input.as_found = OneDrifted();
  SensorFound& right = input.as_found->sensors[0];
  right.state = FoundState::kNotToldApart;
  right.axes.fill(FoundState::kNotToldApart);
  const std::string section = Section(input);
  EXPECT_THAT(section, HasSubstr("<bdi>front_right</bdi><br><span class=\"badge unknown\">not told apart from "
                                 "scatter</span></th><td class=\"text\">x</td><td>1.20 mm</td>"));
  EXPECT_THAT(section, Not(HasSubstr("unchanged")));
}

TEST(AsFoundSection, TellsRatesAndWhoElseMayHaveMoved) {
  ReportInput input = SampleReport();
  input.as_found = OneDrifted();
  input.as_found->sensors[0].or_else = SensorId("front_left");
  input.as_found->sensors[0].rate = DriftRate{3, {1}, {2}, 3e-4 * Vector6d::Ones(), 1e-4 * Vector6d::Ones()};
  const std::string section = Section(input);
  EXPECT_THAT(section, HasSubstr("Change in<br>30 days"));
  EXPECT_THAT(section, HasSubstr("<td>0.30 \xC2\xB1 0.10 mm</td>"));
  EXPECT_THAT(section, HasSubstr("or <bdi>front_left</bdi>"));
}

TEST(AsFoundSection, SaysWhyNothingWasTestedWithoutATable) {
  ReportInput input = SampleReport();
  input.as_found = OneDrifted();
  input.as_found->why_not = "No calibration was in use before it.";
  input.as_found->text = "As found (session of 2026-11-03): not tested. No calibration was in use before it.";
  EXPECT_THAT(Section(input), HasSubstr(input.as_found->text));
  EXPECT_THAT(Section(input), Not(HasSubstr("<table")));
}

}  // namespace
}  // namespace rigcal::report
