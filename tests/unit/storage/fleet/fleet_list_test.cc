// The list of all robots: search, choice, order, pages, counts.
#include "storage/fleet/fleet_list.h"

#include <gmock/gmock.h>

#include "storage/fleet/robot_summary.h"
#include "tests/unit/storage/fixture.h"

namespace rigcal::storage {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr Stamp kNow{1000 * kDay_ns};

RobotSummary JudgedRobot(const std::string& name, VerdictLevel level, std::int64_t edges = 1) {
  RobotSummary summary;
  summary.robot = RobotId(name);
  summary.revision = 1;
  summary.verdict = {level, "why of " + name, ""};
  summary.validity.calibrated_at = Stamp{kNow.ns - kDay_ns};
  summary.edges = edges;
  return summary;
}

RobotSummary Overdue(const std::string& name, VerdictLevel level) {
  RobotSummary summary = JudgedRobot(name, level);
  summary.validity.calibrated_at = Stamp{kNow.ns - kDefaultMaxAge_ns - 1};
  return summary;
}

class FleetListTest : public StoreTest {
 protected:
  void Append(const std::vector<RobotSummary>& robots) {
    const Status appended = store_.Write([&]() -> Status {
      for (const RobotSummary& summary : robots) {
        RIGCAL_TRY(AppendRobot(store_, summary.robot, {1}));
        RIGCAL_TRY(ReplaceSummary(store_, summary, 1));
      }
      return {};
    });
    ASSERT_TRUE(appended) << WordsOf(appended.error());
  }
  FleetPage Page(const FleetQuery& asked) {
    const auto page = LoadFleetPage(store_, asked, kNow);
    EXPECT_TRUE(page) << WordsOf(page);
    return page.value_or(FleetPage{});
  }
  std::vector<std::string> Names(const FleetQuery& asked) {
    std::vector<std::string> names;
    for (const RobotSummary& row : Page(asked).rows) names.push_back(row.robot.str());
    return names;
  }
};

TEST_F(FleetListTest, SearchesFiltersSortsAndTurnsPages) {
  std::vector<RobotSummary> robots = {JudgedRobot("alpha-1", VerdictLevel::kPass, 5),
                                      JudgedRobot("beta-2", VerdictLevel::kFail, 9),
                                      JudgedRobot("Alpha-3", VerdictLevel::kWarn, 7)};
  Append(robots);
  EXPECT_THAT(Names({}), ElementsAre("beta-2", "Alpha-3", "alpha-1"));
  EXPECT_THAT(Names({"ALPHA why", "", "robot", false, 1}), ElementsAre("Alpha-3", "alpha-1"));
  EXPECT_THAT(Names({"", "fail", "", false, 1}), ElementsAre("beta-2"));
  EXPECT_THAT(Names({"", "no such choice", "", false, 1}), IsEmpty());
  EXPECT_THAT(Names({"", "", "edges", true, 1}), ElementsAre("alpha-1", "Alpha-3", "beta-2"));
  EXPECT_EQ(Page({"nobody", "", "", false, 1}).matches, 0U);
  EXPECT_EQ(Page({"nobody", "", "", false, 1}).pages, 1U);
  robots.clear();
  for (int i = 0; i < 250; ++i) robots.push_back(JudgedRobot("more-" + std::to_string(1000 + i), VerdictLevel::kPass));
  Append(robots);
  const FleetPage last = Page({"", "", "robot", false, 99});
  EXPECT_EQ(last.matches, 253U);
  EXPECT_EQ(last.pages, 3U);
  EXPECT_EQ(last.page, 3U);
  EXPECT_EQ(last.rows.size(), 53U);
  EXPECT_EQ(last.rows.back().robot.str(), "more-1249");
  EXPECT_EQ(Page({"", "", "robot", false, 2}).rows.front().robot.str(), "more-1097");
}

// Whatever a row shows is found.
TEST_F(FleetListTest, SearchesSiteStatusAndWhatARobotRuns) {
  RobotSummary here = JudgedRobot("a", VerdictLevel::kWarn), there = JudgedRobot("b", VerdictLevel::kPass);
  here.site = "Hall 3";
  here.found = {StatusWord::kOutOfTolerance, "The pose of mast is known to 12 mm only.", ""};
  there.runs = Runs{7, "it runs a revision of before", ""};
  Append({here, there});
  EXPECT_THAT(Names({"hall 3", "", ""}), ElementsAre("a"));
  EXPECT_THAT(Names({"out-of-tolerance mast", "", ""}), ElementsAre("a"));
  EXPECT_THAT(Names({"of before", "", ""}), ElementsAre("b"));
}

TEST_F(FleetListTest, NamesAreOrderedAsPeopleCount) {
  std::vector<RobotSummary> robots;
  for (const char* name : {"r10", "r9", "r010", "r9b", "r", "r9a10", "r9a9"})
    robots.push_back(JudgedRobot(name, VerdictLevel::kPass));
  Append(robots);
  EXPECT_THAT(Names({"", "", "robot", false, 1}), ElementsAre("r", "r9", "r9a9", "r9a10", "r9b", "r010", "r10"));
  EXPECT_THAT(Names({"", "", "robot", true, 1}), ElementsAre("r10", "r010", "r9b", "r9a10", "r9a9", "r9", "r"));
}

TEST_F(FleetListTest, ANumberStandsAmongOtherCharactersAsADigit) {
  std::vector<RobotSummary> robots;
  for (const char* name : {"a_1", "a1", "ab", "a-1", "a.1", "a00", "a0", "aB"})
    robots.push_back(JudgedRobot(name, VerdictLevel::kPass));
  Append(robots);
  EXPECT_THAT(Names({"", "", "robot", false, 1}), ElementsAre("a-1", "a.1", "a0", "a00", "a1", "aB", "a_1", "ab"));
}

// What is overdue goes before what only warns, and what is due soon before what passes.
TEST_F(FleetListTest, TheMostUrgentIsFirst) {
  std::vector<RobotSummary> robots = {
      JudgedRobot("pass", VerdictLevel::kPass), JudgedRobot("warn", VerdictLevel::kWarn),
      JudgedRobot("unknown", VerdictLevel::kUnknown), JudgedRobot("fail", VerdictLevel::kFail)};
  for (const RobotSummary& current : std::vector(robots))
    robots.push_back(Overdue("late-" + current.robot.str(), current.verdict.level));
  robots.push_back(JudgedRobot("z-soon", VerdictLevel::kPass));
  robots.back().validity.calibrated_at = Stamp{kNow.ns - kDefaultMaxAge_ns};  // overdue from now on
  robots.push_back(JudgedRobot("new", VerdictLevel::kUnknown));
  robots.back().revision = 0;
  robots.back().validity.calibrated_at.reset();
  Append(robots);
  EXPECT_THAT(Names({}), ElementsAre("late-fail", "fail", "late-unknown", "new", "unknown", "late-warn", "late-pass",
                                     "warn", "z-soon", "pass"));
  EXPECT_THAT(Names({"", "", "urgency", true, 1}), ElementsAre("pass", "z-soon", "warn", "late-pass", "late-warn",
                                                               "new", "unknown", "late-unknown", "fail", "late-fail"));
  EXPECT_THAT(Names({"", "overdue", "robot", false, 1}),
              ElementsAre("late-fail", "late-pass", "late-unknown", "late-warn"));
}

TEST_F(FleetListTest, LastSessionAndWorstEdgeAreSearchedAndSorted) {
  RobotSummary quiet = JudgedRobot("quiet", VerdictLevel::kPass), off = JudgedRobot("off", VerdictLevel::kPass),
               fine = JudgedRobot("fine", VerdictLevel::kPass);
  quiet.last_session_at = Stamp{kNow.ns - 90 * kDay_ns};
  off.last_session_at = Stamp{kNow.ns - kDay_ns};
  off.worst = WorstEdge{SensorId("left"), SensorId("mast"), 4.25};
  fine.last_session_at = Stamp{kNow.ns - 2 * kDay_ns};
  fine.worst = WorstEdge{SensorId("left"), SensorId("right"), 0.5};
  Append({quiet, off, fine});
  EXPECT_THAT(Names({"", "", "worst", false, 1}), ElementsAre("off", "fine", "quiet"));
  EXPECT_THAT(Names({"", "", "session", false, 1}), ElementsAre("quiet", "fine", "off"));
  EXPECT_THAT(Names({"", "", "session", true, 1}), ElementsAre("off", "fine", "quiet"));
  EXPECT_THAT(Names({"MAST", "", "", false, 1}), ElementsAre("off"));
  EXPECT_THAT(Names({"", "off", "", false, 1}), ElementsAre("off"));
  EXPECT_THAT(Names({"", "quiet", "", false, 1}), ElementsAre("quiet"));
}

TEST_F(FleetListTest, LimitsAreExact) {
  RobotSummary at_30_days = JudgedRobot("at-30-days", VerdictLevel::kPass),
               older = JudgedRobot("older", VerdictLevel::kPass), none = JudgedRobot("none", VerdictLevel::kPass);
  at_30_days.last_session_at = Stamp{kNow.ns - kQuiet_ns};
  older.last_session_at = Stamp{kNow.ns - kQuiet_ns - 1};
  at_30_days.worst = WorstEdge{SensorId("a"), SensorId("b"), kOff_sigmas};
  older.worst = WorstEdge{SensorId("a"), SensorId("b"), 2.9999};
  Append({at_30_days, older, none});
  EXPECT_THAT(Names({"", "quiet", "robot", false, 1}), ElementsAre("none", "older"));
  EXPECT_THAT(Names({"", "off", "", false, 1}), ElementsAre("at-30-days"));
}

TEST_F(FleetListTest, EqualOnesAreInTheOrderOfTheirNames) {
  std::vector<RobotSummary> robots;
  for (const char* name : {"b10", "b9", "a"}) robots.push_back(JudgedRobot(name, VerdictLevel::kPass, 4));
  robots[2].worst = WorstEdge{SensorId("x"), SensorId("y"), 1e300};
  robots[0].worst = WorstEdge{SensorId("x"), SensorId("y"), 2e12};  // beyond 1e12 all are alike
  Append(robots);
  for (const bool descending : {false, true})
    for (const char* sort : {"edges", "revision", "sessions", "calibrated", "session"})
      EXPECT_THAT(Names({"", "", sort, descending, 1}), ElementsAre("a", "b9", "b10")) << sort;
  EXPECT_THAT(Names({"", "", "worst", false, 1}), ElementsAre("a", "b10", "b9"));
}

TEST_F(FleetListTest, WordsMayBeAnything) {
  Append({JudgedRobot("r1", VerdictLevel::kPass), JudgedRobot("r2", VerdictLevel::kFail)});
  EXPECT_THAT(Names({"  why   of R2 fail ", "", "", false, 1}), ElementsAre("r2"));
  for (const char* odd : {"%", "_", "\"quoted\" why", "why \\", "why '", "why ?1", "why [1]"})
    EXPECT_THAT(Names({odd, "", "", false, 1}), IsEmpty()) << odd;
  EXPECT_THAT(Names({"why of of of of of of of of of of of of", "", "robot", false, 1}), ElementsAre("r1", "r2"));
}

TEST_F(FleetListTest, AllAreCounted) {
  EXPECT_EQ(CountFleet(store_, kNow)->robots, 0);
  RobotSummary busy = JudgedRobot("busy", VerdictLevel::kPass, 5);
  busy.sessions = 3, busy.jobs_waiting = 2;
  Append({busy, JudgedRobot("a", VerdictLevel::kPass, 7), Overdue("b", VerdictLevel::kFail),
          JudgedRobot("c", VerdictLevel::kUnknown)});
  FleetCounts fleet = CountFleet(store_, kNow).value();
  EXPECT_EQ(fleet.robots, 4);
  EXPECT_EQ(fleet.overdue, 1);
  EXPECT_EQ(fleet.edges, 14);
  EXPECT_EQ(fleet.sessions, 3);
  EXPECT_EQ(fleet.jobs_waiting, 2);
  EXPECT_EQ(fleet.verdicts[VerdictLevel::kPass], 2);
  EXPECT_EQ(fleet.verdicts[VerdictLevel::kFail], 1);
  EXPECT_EQ(fleet.verdicts[VerdictLevel::kUnknown], 1);
  EXPECT_EQ(fleet.verdicts[VerdictLevel::kWarn], 0);
  EXPECT_EQ(fleet.kinds, (std::map<DriveKind, std::int64_t>{
                             {DriveKind::kDoNotDrive, 1}, {DriveKind::kNotVerified, 1}, {DriveKind::kToApprove, 2}}));
  EXPECT_EQ(CountFleet(store_, {kNow.ns + kDefaultMaxAge_ns})->overdue, 4);
}

// The counts and the choices of the list, which the database works out, are those of the rules that the rows show.
TEST_F(FleetListTest, KindsAreThoseOfTheDriveRules) {
  std::vector<RobotSummary> robots;
  const std::vector<std::optional<Runs>> all_runs = {
      std::nullopt, Runs{1, "", "revision 1"},
      Runs{3, "It runs revision 3; revision 1 is in use: not applied yet.", "revision 3"}};
  for (const VerdictLevel level :
       {VerdictLevel::kPass, VerdictLevel::kWarn, VerdictLevel::kFail, VerdictLevel::kUnknown})
    for (const bool late : {false, true})
      for (const bool approved : {false, true})
        for (const auto& runs : all_runs) {
          const std::string name = "r" + std::to_string(robots.size());
          RobotSummary robot = late ? Overdue(name, level) : JudgedRobot(name, level);
          if (approved) robot.validity.usable = UsableRevision{1, {}};
          robot.runs = runs;
          robots.push_back(robot);
        }
  Append(robots);
  std::map<DriveKind, std::int64_t> kinds;
  for (const RobotSummary& row : Page({"", "", "robot", false, 1}).rows)
    ++kinds[DriveRuleOf(row.verdict, row.validity, row.runs).kind];
  EXPECT_EQ(CountFleet(store_, kNow)->kinds, kinds);
  for (const DriveKind kind : kDriveKinds) {
    const FleetPage page = Page({"", NameOf(kind), "robot", false, 1});
    EXPECT_EQ(static_cast<std::int64_t>(page.matches), kinds[kind]) << NameOf(kind);
    for (const RobotSummary& row : page.rows)
      EXPECT_EQ(DriveRuleOf(row.verdict, row.validity, row.runs).kind, kind) << row.robot.str();
  }
}

}  // namespace
}  // namespace rigcal::storage
