// What a row of the list of robots names, which columns there are, and the small drawing of its calibrations.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/report/drawings/calibration_strip.h"
#include "server/report/render.h"
#include "server/report/text/text.h"
#include "tests/unit/report/sample.h"

namespace rigcal::report {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const Stamp kNow = ParseIso("2026-05-20T12:00:00Z").value();

RobotSummary Weekly(const std::string& name) {
  RobotSummary robot;
  robot.robot = RobotId(name);
  robot.revision = 3;
  robot.verdict = {VerdictLevel::kPass, "All is well.", ""};
  robot.validity.calibrated_at = Stamp{kNow.ns - 10 * kDay_ns};
  robot.last_session_at = robot.validity.calibrated_at;
  return robot;
}

std::string PageOf(const RobotSummary& robot, bool has_models = true, bool has_sites = true,
                   bool has_operators = true) {
  FleetCounts fleet;
  fleet.robots = 1;
  if (has_models) fleet.models = {{"mars-mapper", 1, 0}};
  fleet.with_site = has_sites ? 1 : 0;
  fleet.with_operator = has_operators ? 1 : 0;
  return RenderFleet(fleet, {{robot}, 1, 1, 1}, kNow, {}).value();
}

TEST(FleetColumns, NameModelSiteAndOperatorAndLeadToWhoSharesThem) {
  RobotSummary robot = Weekly("r");
  robot.rig_model = "mars <b> & co", robot.site = "hall 3", robot.operator_name = "Ada <i>";
  const std::string page = PageOf(robot);
  EXPECT_THAT(page, HasSubstr("data-label=\"Rig model\"><a class=\"name\" dir=\"auto\" "
                              "href=\"?model=mars+%3Cb%3E+%26+co\">mars &lt;b&gt; &amp; co</a>"));
  EXPECT_THAT(page, HasSubstr("href=\"?site=hall+3\">hall 3</a>"));
  EXPECT_THAT(page, HasSubstr("by <bdi>Ada &lt;i&gt;</bdi>"));
  for (const char* heading : {"sort=model&amp;order=\">Rig model", "sort=site&amp;order=\">Site",
                              "sort=due&amp;order=\">Due", "sort=operator&amp;order=\">Operator"})
    EXPECT_THAT(page, HasSubstr(heading));
}

TEST(FleetColumns, WhatIsNotKnownIsNotSaid) {
  const std::string page = PageOf(Weekly("r"));
  EXPECT_THAT(page, HasSubstr("<td class=\"text place\"></td>"));
  EXPECT_THAT(page, Not(HasSubstr("by <bdi>")));
  RobotSummary placed = Weekly("r");
  placed.site = "hall 3";
  EXPECT_THAT(PageOf(placed), HasSubstr("data-label=\"Site\">"));
  const std::string nothing = PageOf(Weekly("r"), false, false, false);
  for (const char* heading : {">Rig model", ">Site", ">Operator", "class=\"text place"})
    EXPECT_THAT(nothing, Not(HasSubstr(heading))) << "no robot has one";
  EXPECT_THAT(PageOf(placed, false, true, false), AllOf(HasSubstr(">Site"), Not(HasSubstr(">Rig model"))));
}

TEST(FleetColumns, DueIsTheEarlierOfAgeAndDrift) {
  RobotSummary robot = Weekly("r");
  EXPECT_THAT(PageOf(robot),
              AllOf(HasSubstr("<span class=\"soft due\">due 8 Aug 2026</span>"), Not(HasSubstr("by drift"))));
  robot.drift_due = DriftDue{SensorId("mast"), Stamp{kNow.ns + 5 * kDay_ns}};
  EXPECT_THAT(PageOf(robot), AllOf(HasSubstr("<span class=\"soft due\">due 25 May 2026</span>"),
                                   HasSubstr("by drift of mast; by age 8 Aug 2026")));
  robot.drift_due->at = Stamp{kNow.ns + 500 * kDay_ns};
  EXPECT_THAT(PageOf(robot), AllOf(HasSubstr("due 8 Aug 2026"), Not(HasSubstr("by drift"))));
}

TEST(CalibrationStrip, DrawsEachCalibrationWhereItWasAndHowOldItBecame) {
  RobotSummary robot = Weekly("r");
  // Over 100 days, 126 px: on the left side, after 90 days on the right; 3 sigma is half of the height of 17 px.
  robot.calibrations = {{Stamp{kNow.ns - 100 * kDay_ns}, 0.0}, {Stamp{kNow.ns - 10 * kDay_ns}, 3.0}};
  const std::string page = PageOf(robot);
  EXPECT_THAT(page, HasSubstr("<path class=\"fit0\" d=\"M3.0 20.0h0\"/>"));
  EXPECT_THAT(page, HasSubstr("<path class=\"fit3\" d=\"M116.4 11.5h0\"/>"));
  // 90 days are the limit: to the top; the last 10 days a ninth of the height of 12 px.
  EXPECT_THAT(page, HasSubstr("d=\"M3.0 35.0L116.4 23.0V35.0L129.0 33.7V35.0Z\""));
  EXPECT_THAT(page, HasSubstr("d=\"M3 11.5H129M3 23.0H129\""));
  EXPECT_THAT(page, HasSubstr("aria-label=\"2 calibrations since 9 Feb 2026, at most "));
  EXPECT_THAT(page, HasSubstr("Small drawings:"));
}

TEST(CalibrationStrip, WhatIsBeyondStandsAtTheEdge) {
  RobotSummary robot = Weekly("r");
  robot.calibrations = {{Stamp{kNow.ns - 400 * kDay_ns}, 1e12}, {Stamp{kNow.ns + kDay_ns}, 2.5}};
  const std::string page = PageOf(robot);
  EXPECT_THAT(page, HasSubstr("<path class=\"fit3\" d=\"M3.0 3.0h0\"/>")) << "beyond 6 sigma";
  EXPECT_THAT(page, HasSubstr("<path class=\"fit2\" d=\"M129.0 ")) << "a clock that went back";
  const std::size_t svg = page.find("<svg class=\"calibrations\"");
  const std::string drawing = page.substr(svg, page.find("</svg>", svg) - svg);
  for (const char* wrong : {"nan", "inf", " -", "not known"}) EXPECT_THAT(drawing, Not(HasSubstr(wrong)));
}

TEST(CalibrationStrip, OneCalibrationIsNoCourse) {
  RobotSummary robot = Weekly("r");
  robot.calibrations = {{*robot.validity.calibrated_at, 1.0}};
  EXPECT_THAT(PageOf(robot), AllOf(Not(HasSubstr("class=\"calibrations\"")), Not(HasSubstr("Small drawings:"))));
}

TEST(CalibrationStrip, IsToldInWords) {
  const Stamp first = ParseIso("2026-01-03").value();
  std::vector<CalibrationPoint> points = {{first}, {Stamp{first.ns + 20 * kDay_ns}}, {Stamp{first.ns + 25 * kDay_ns}}};
  EXPECT_EQ(CalibrationStripText(points), "3 calibrations since 3 Jan 2026, at most 20 days apart");
  points[0].worst_sigmas = 3.25, points[2].worst_sigmas = 0.5;
  EXPECT_EQ(CalibrationStripText(points),
            "3 calibrations since 3 Jan 2026, at most 20 days apart; worst edge 0.5 to 3.2 sigma");
}

TEST(Addresses, HoldAnyWords) {
  EXPECT_EQ(InAddress("a b+c&d=e#f%g/\xC3\xA9"), "a+b%2Bc%26d%3De%23f%25g%2F%C3%A9");
  EXPECT_EQ(InAddress("not_measured a.b-c~1"), "not_measured+a.b-c~1");
}

}  // namespace
}  // namespace rigcal::report
