// What the fleet's page says is to be worked on, its rows in one line, and the list for spreadsheets.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/report/pages/fleet_csv.h"
#include "server/report/render.h"
#include "server/report/text/cause_words.h"

namespace rigcal::report {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

RobotSummary Late(const std::string& name) {
  RobotSummary robot;
  robot.robot = RobotId(name);
  robot.revision = 3;
  robot.verdict = {VerdictLevel::kWarn, "Pairs failed, \"many\".", "=Measure, then push."};
  robot.validity.calibrated_at = ParseIso("2026-01-31T12:00:00Z").value();
  robot.validity.overdue = true;
  robot.causes = {"board_size panel larger", "failed_pair cam_left lidar_top"};
  robot.sessions = 2, robot.edges = 7, robot.jobs_waiting = 1;
  robot.rig_model = "mars-mapper", robot.operator_name = "Ada, Bo";
  robot.calibrations = {{ParseIso("2026-01-01").value(), 0.42}, {ParseIso("2026-01-31T12:00:00Z").value()}};
  return robot;
}

FleetCounts Counts() {
  FleetCounts fleet;
  fleet.robots = 20;
  fleet.overdue = 4;
  fleet.due_next_week = 1;
  fleet.causes = {{"failed_pair cam_left lidar_top", 12},
                  {"board_size panel larger", 3},
                  {"short_session", 1},
                  {"not_measured a b c d +2", 1}};
  return fleet;
}

const Stamp kAskedAt = ParseIso("2026-05-20T12:00:00Z").value();

std::string PageOf(const FleetCounts& fleet, const FleetQuery& query = {}) {
  return RenderFleet(fleet, {{Late("late")}, 1, 1, 1}, kAskedAt, query).value();
}

TEST(CauseWords, SayWhatIsTheMatter) {
  EXPECT_EQ(CauseText("failed_pair cam_left lidar_top"), "cam_left - lidar_top failed");
  EXPECT_EQ(CauseText("moved cam_left"), "cam_left moved");
  EXPECT_EQ(CauseText("moved cam_left cam_right"), "cam_left or cam_right moved");
  EXPECT_EQ(CauseText("moved_within cam_left cam_right"), "cam_left or cam_right moved during a session");
  EXPECT_EQ(CauseText("board_size panel larger"), "board panel larger than given");
  EXPECT_EQ(CauseText("board_size a b smaller"), "board a, b smaller than given");
  EXPECT_EQ(CauseText("board_size larger"), "board larger than given") << "no board is known by name";
  EXPECT_EQ(CauseText("board_size panel disputed"), "size of board panel disputed");
  EXPECT_EQ(CauseText("board_counts panel"), "board panel found in no picture");
  EXPECT_EQ(CauseText("lens_model left fisheye_kb4"), "lens of left is fisheye_kb4");
  EXPECT_EQ(CauseText("exchanged left right"), "left, right exchanged");
  EXPECT_EQ(CauseText("not_measured a b c d +2"), "a, b, c, d and 2 more not measured");
  EXPECT_EQ(CauseText("short_session"), "session of a few captures");
  EXPECT_EQ(CauseText("more_causes"), "more causes than are listed");
}

TEST(CauseWords, OfALaterVersionAreItsOwn) {
  EXPECT_EQ(CauseText("clock_offset imu"), "clock offset imu");
  EXPECT_EQ(CauseText(""), "");
  EXPECT_EQ(CauseText("lens_model"), "lens of is ") << "nothing breaks";
}

TEST(WorkLists, CountRobotsByCauseAndOpenTheirLists) {
  const std::string page = PageOf(Counts());
  EXPECT_THAT(page, HasSubstr("?cause=failed_pair+cam_left+lidar_top\">cam_left - lidar_top failed</a>: 12 robots"));
  EXPECT_THAT(page, HasSubstr("?cause=board_size+panel+larger\">board panel larger than given</a>: 3 robots"));
  EXPECT_THAT(page, HasSubstr("session of a few captures</a>: 1 robot<"));
  EXPECT_THAT(page, HasSubstr("?cause=not_measured+a+b+c+d+%2B2\">")) << "a sign is no blank";
  EXPECT_LT(page.find("By cause"), page.find("<table")) << "above the list";
  EXPECT_THAT(page, Not(HasSubstr("others on fewer robots")));
}

TEST(WorkLists, CountRobotsByTheWeekTheyAreDueIn) {
  const std::string page = PageOf(Counts());
  EXPECT_THAT(page, HasSubstr("<a href=\"?verdict=overdue\">overdue</a>: 4 robots"));
  EXPECT_THAT(page, HasSubstr("<a href=\"?verdict=next_week\">due next week</a>: 1 robot<"));
  EXPECT_THAT(page, Not(HasSubstr("<a href=\"?verdict=this_week\">")));
  EXPECT_THAT(page, HasSubstr("<option value=\"this_week\">due this week</option>"));
}

TEST(WorkLists, WhereThereIsNothingToDoThereAreNone) {
  FleetCounts fleet;
  fleet.robots = 20;
  EXPECT_THAT(PageOf(fleet), Not(HasSubstr("class=\"card work\"")));
}

TEST(WorkLists, RareCausesAreInTheDownload) {
  FleetCounts fleet = Counts();
  while (fleet.causes.size() <= kCausesListedMax)
    fleet.causes.push_back({"board_unseen camera_" + std::to_string(fleet.causes.size()), 1});
  const std::string page = PageOf(fleet);
  EXPECT_THAT(page, HasSubstr("others on fewer robots"));
  EXPECT_THAT(page, HasSubstr("camera_11 sees no board"));
  EXPECT_THAT(page, Not(HasSubstr("camera_12 sees no board")));
}

TEST(WorkLists, AListOfOneCauseSaysSoAndStaysWithIt) {
  const std::string page = PageOf(Counts(), {"r", "warn", "edges", true, 1, "board_size panel larger"});
  EXPECT_THAT(
      page,
      HasSubstr(
          "<p class=\"only\"><bdi>board panel larger than given</bdi> <a href=\"?q=r&amp;verdict=warn&amp;sort=edges"
          "&amp;order=down\">all causes</a>"));
  EXPECT_THAT(page, HasSubstr("<input type=\"hidden\" name=\"cause\" value=\"board_size panel larger\">"));
  EXPECT_THAT(page, HasSubstr("&amp;sort=robot&amp;order=&amp;cause=board_size+panel+larger\">Robot"));
  EXPECT_THAT(page, HasSubstr("href=\"fleet.csv?q=r&amp;verdict=warn&amp;sort=edges&amp;order=down"
                              "&amp;cause=board_size+panel+larger\" download>"));
  const std::string all = PageOf(Counts());
  EXPECT_THAT(all, Not(HasSubstr("class=\"only\"")));
  EXPECT_THAT(all, Not(HasSubstr("name=\"cause\"")));
}

TEST(WorkLists, CountRobotsOfAModelThatAreToBeLookedAt) {
  FleetCounts fleet = Counts();
  fleet.models = {{"mars & co", 17, 3}, {"still", 4, 0}};
  const std::string page = PageOf(fleet);
  EXPECT_THAT(page, HasSubstr("<a href=\"?model=mars+%26+co&amp;status=work\">mars &amp; co</a>: 3 of 17 robots"));
  EXPECT_THAT(page, Not(HasSubstr("?model=still&amp;status=work")));
  EXPECT_THAT(page, HasSubstr("<option value=\"work\">all but ok</option>"));
  for (int i = 0; i < 20; ++i) fleet.models.insert(fleet.models.begin(), {"m" + std::to_string(i), 9, 9});
  EXPECT_THAT(PageOf(fleet),
              AllOf(HasSubstr("?model=m8&amp;status=work"), Not(HasSubstr("?model=m7&amp;status=work"))));
}

TEST(WorkLists, AChoiceIsToldWithAWayBackThatKeepsTheOthers) {
  FleetQuery query{"a&b", "", "due", false, 3, "short_session", "due", "hall 3"};
  query.model = "mars";
  const std::string page = PageOf(Counts(), query), rest = "?q=a%26b&amp;verdict=&amp;sort=due&amp;order=";
  EXPECT_THAT(page, HasSubstr("<bdi>session of a few captures</bdi> <a href=\"" + rest +
                              "&amp;status=due&amp;site=hall+3&amp;model=mars\">all causes</a>"));
  EXPECT_THAT(page, HasSubstr("<bdi>Rig model mars</bdi> <a href=\"" + rest +
                              "&amp;cause=short_session&amp;status=due&amp;site=hall+3\">all rig models</a>"));
  EXPECT_THAT(page, HasSubstr("<bdi>Site hall 3</bdi> <a href=\"" + rest +
                              "&amp;cause=short_session&amp;status=due&amp;model=mars\">all sites</a>"));
  EXPECT_THAT(page, HasSubstr("<input type=\"hidden\" name=\"model\" value=\"mars\">"));
}

TEST(FleetRows, SayUntilWhenARobotIsCalibrated) {
  EXPECT_THAT(PageOf(Counts()), HasSubstr("<span class=\"soft due\">due 1 May 2026</span>"));
}

TEST(FleetCsv, HasARowForARobot) {
  const std::string heading = FleetCsvHeading();
  EXPECT_EQ(FleetCsvRow(Late("late"), kAskedAt),
            "late,warn,yes,2026-05-01T12:00:00Z,2026-01-31T12:00:00Z,,3,2,7,1,,,,"
            "board panel larger than given; cam_left - lidar_top failed,\"Pairs failed, \"\"many\"\".\","
            "\"'=Measure, then push.\",unusable,,,,overdue,It was to be calibrated again by 1 May 2026.,Capture a "
            "session and push it.,"
            "2026-05-01T12:00:00Z,,,,mars-mapper,\"Ada, Bo\",2026-01-01T00:00:00Z 0.420; 2026-01-31T12:00:00Z -\r\n");
  RobotSummary fresh;
  fresh.robot = RobotId("fresh");
  fresh.worst = WorstEdge{SensorId("left"), SensorId("mast"), 4.25};
  EXPECT_EQ(FleetCsvRow(fresh, kAskedAt), "fresh,unknown,no,,,,,0,0,0,left,mast,4.250,,,,,,,,unknown,,,,,,,,,\r\n");
  fresh.validity.usable = UsableRevision{5, {}};
  fresh.runs = Runs{3, "It runs revision 3; revision 5 is in use: not applied yet."};
  EXPECT_THAT(FleetCsvRow(fresh, kAskedAt),
              HasSubstr(",5,3,It runs revision 3; revision 5 is in use: not applied yet.,unknown,"));
  const auto commas = [](const std::string& row) { return std::count(row.begin(), row.end(), ','); };
  EXPECT_EQ(commas(FleetCsvRow(fresh, kAskedAt)), commas(heading));
}

}  // namespace
}  // namespace rigcal::report
