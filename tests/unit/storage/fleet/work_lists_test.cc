// What the fleet is to be worked on by: causes that robots have in common, when they are due, and the whole of a list.
#include <gmock/gmock.h>

#include "storage/fleet/fleet_facts.h"
#include "storage/fleet/fleet_list.h"
#include "storage/fleet/robot_summary.h"
#include "tests/unit/storage/fixture.h"
#include "tests/unit/storage/old_store.h"

namespace rigcal::storage {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

const Stamp kWednesday = ParseIso("2026-02-04T12:00:00Z").value();

RobotSummary WarnedRobot(const std::string& name, const std::vector<std::string>& causes = {}) {
  RobotSummary summary;
  summary.robot = RobotId(name);
  summary.revision = 4;
  summary.verdict = {VerdictLevel::kWarn, "Two pairs failed.", "Show the board."};
  summary.validity.calibrated_at = Stamp{kWednesday.ns - kDay_ns};
  summary.causes = causes;
  return summary;
}

RobotSummary DueIn(const std::string& name, std::int64_t after_ns) {
  RobotSummary summary = WarnedRobot(name);
  summary.validity.calibrated_at = Stamp{kWednesday.ns + after_ns - kDefaultMaxAge_ns};
  return summary;
}

class WorkListsTest : public StoreTest {
 protected:
  // What was stored of the same robots before is older.
  void Store(const std::vector<RobotSummary>& robots) {
    ++changes_;
    const Status stored = store_.Write([&]() -> Status {
      for (const RobotSummary& summary : robots) {
        RIGCAL_TRY(AppendRobot(store_, summary.robot, {1}));
        RIGCAL_TRY(ReplaceSummary(store_, summary, changes_));
      }
      return {};
    });
    ASSERT_TRUE(stored) << WordsOf(stored.error());
  }
  std::vector<std::string> Counts(std::size_t max = 20) {
    std::vector<std::string> texts;
    const auto counts = LoadCauseCounts(store_, max);
    EXPECT_TRUE(counts) << WordsOf(counts);
    for (const CauseCount& one : *counts) texts.push_back(one.key + ": " + std::to_string(one.robots));
    return texts;
  }
  std::vector<std::string> Names(const FleetQuery& asked) {
    std::vector<std::string> names;
    const auto page = LoadFleetPage(store_, asked, kWednesday);
    EXPECT_TRUE(page) << WordsOf(page);
    for (const RobotSummary& row : page->rows) names.push_back(row.robot.str());
    EXPECT_EQ(page->matches, names.size());
    return names;
  }
  std::vector<std::string> Searched(const std::string& words) { return Names({words, "", "robot", false, 1}); }

  std::int64_t changes_ = 0;
};

TEST_F(WorkListsTest, RobotsAreCountedByTheirCausesTheMostFirst) {
  EXPECT_THAT(Counts(), IsEmpty());
  Store({WarnedRobot("a", {"board_size panel larger", "short_session"}), WarnedRobot("b", {"short_session"}),
         WarnedRobot("c"), WarnedRobot("d", {"failed_pair left top"})});
  EXPECT_THAT(Counts(), ElementsAre("short_session: 2", "board_size panel larger: 1", "failed_pair left top: 1"));
  EXPECT_THAT(Counts(1), ElementsAre("short_session: 2"));
}

TEST_F(WorkListsTest, WhatARobotHasNoMoreIsCountedNoMore) {
  Store({WarnedRobot("a", {"board_size panel larger", "short_session"}), WarnedRobot("b", {"short_session"})});
  Store({WarnedRobot("a", {"short_session"})});
  EXPECT_THAT(Counts(), ElementsAre("short_session: 2"));
  Store({WarnedRobot("a"), WarnedRobot("b")});
  EXPECT_THAT(Counts(), IsEmpty());
  EXPECT_EQ(IntIn(store_, "SELECT count(*) FROM summary_cause"), 0);
  EXPECT_EQ(IntIn(store_, "SELECT count(*) FROM summary_cause_count"), 0);
}

TEST_F(WorkListsTest, AnOlderSummaryChangesNoCount) {
  Store({WarnedRobot("a", {"short_session"})});
  ASSERT_TRUE(ReplaceSummary(store_, WarnedRobot("a", {"board_unseen rear"}), changes_ - 1));
  ASSERT_TRUE(ReplaceSummary(store_, WarnedRobot("a", {"board_unseen rear"}), changes_));
  EXPECT_THAT(Counts(), ElementsAre("short_session: 1"));
}

TEST_F(WorkListsTest, ACountOpensTheListOfItsRobots) {
  Store({WarnedRobot("alpha", {"board_size panel larger", "short_session"}), WarnedRobot("omega", {"short_session"}),
         WarnedRobot("sigma")});
  EXPECT_THAT(Names({"", "", "robot", false, 1, "short_session"}), ElementsAre("alpha", "omega"));
  EXPECT_THAT(Names({"", "", "robot", false, 1, "board_size panel larger"}), ElementsAre("alpha"));
  EXPECT_THAT(Names({"", "", "robot", false, 1, "short"}), IsEmpty());
  EXPECT_THAT(Names({"omega", "warn", "robot", false, 1, "short_session"}), ElementsAre("omega"));
  EXPECT_THAT(Names({"omega", "pass", "robot", false, 1, "short_session"}), IsEmpty());
}

// Of what passes that goes first which is due by the end of next week, by its age or by a drift.
TEST_F(WorkListsTest, WhatIsDueByDriftIsAsUrgent) {
  RobotSummary drifts = DueIn("z-drifts", 60 * kDay_ns), rests = DueIn("rests", 60 * kDay_ns);
  drifts.verdict.level = rests.verdict.level = VerdictLevel::kPass;
  drifts.drift_due = DriftDue{SensorId("s"), {kWednesday.ns + kDay_ns}};
  Store({rests, drifts});
  EXPECT_THAT(Names({"", "", ""}), ElementsAre("z-drifts", "rests"));
}

TEST_F(WorkListsTest, RobotsAreDueThisWeekTheNextOrLater) {
  const std::int64_t monday_ns = NextMonday(kWednesday).ns - kWednesday.ns;
  RobotSummary never = WarnedRobot("never"), fresh = WarnedRobot("fresh");
  never.validity.calibrated_at.reset();
  fresh.revision = 0, fresh.validity.calibrated_at.reset();
  Store({DueIn("overdue", -1), DueIn("now", 0), DueIn("sunday", monday_ns - 1), DueIn("monday", monday_ns),
         DueIn("next-sunday", monday_ns + kWeek_ns - 1), DueIn("later", monday_ns + kWeek_ns), never, fresh});
  EXPECT_THAT(Names({"", "overdue", "robot"}), ElementsAre("overdue"));
  EXPECT_THAT(Names({"", "not_calibrated", "robot"}), ElementsAre("fresh", "never"));
  EXPECT_THAT(Searched("not calibrated"), ElementsAre("fresh", "never"));
  EXPECT_THAT(Searched("warning overdue"), ElementsAre("overdue")) << "nothing is late that has no date";
  EXPECT_THAT(Names({"", "this_week", "robot"}), ElementsAre("now", "sunday"));
  EXPECT_THAT(Names({"", "next_week", "robot"}), ElementsAre("monday", "next-sunday"));
  EXPECT_THAT(Names({"", "later", "robot"}), ElementsAre("later"));
  const FleetCounts fleet = CountFleet(store_, kWednesday).value();
  EXPECT_EQ(fleet.overdue, 1);
  EXPECT_EQ(fleet.not_calibrated, 2);
  EXPECT_EQ(fleet.due_this_week, 2);
  EXPECT_EQ(fleet.due_next_week, 2);
  EXPECT_EQ(fleet.due_later, 1);
}

// The date by drift is one as that by age is: what a row shows, the calendar has and `rigcal due` lists is counted.
TEST_F(WorkListsTest, CountsByWeekAreThoseOfTheDatesOfRows) {
  const Stamp monday = NextMonday(kWednesday);
  std::vector<RobotSummary> robots;
  for (const int by_age : {-1, 0, 3, 4, 5, 6, 11, 12, 13, 60})
    for (const int by_drift : {-9, -1, 0, 3, 4, 5, 6, 7, 8, 11, 12, 13, 60}) {
      RobotSummary robot = DueIn("r" + std::to_string(robots.size()), by_age * kDay_ns);
      robot.validity.usable = UsableRevision{4, {}};
      if (by_drift < 60) robot.drift_due = DriftDue{SensorId("s"), {kWednesday.ns + by_drift * kDay_ns}};
      robots.push_back(robot);
    }
  Store(robots);
  std::int64_t overdue = 0, this_week = 0, next_week = 0, later = 0, due = 0;
  const auto later_rows = Names({"", "later", "robot"});
  for (const RobotSummary& robot : robots) {
    const StatusWord word = StatusAt(robot, kWednesday).word;
    const Stamp at = *DueAt(robot.validity, robot.drift_due);
    if (word == StatusWord::kOverdue)
      ++overdue;
    else
      ++(at < monday ? this_week : at.ns < monday.ns + kWeek_ns ? next_week : later);
    due += word == StatusWord::kDue ? 1 : 0;
    EXPECT_FALSE(word == StatusWord::kDue && std::count(later_rows.begin(), later_rows.end(), robot.robot.str()) > 0);
  }
  const FleetCounts fleet = CountFleet(store_, kWednesday).value();
  EXPECT_EQ(fleet.overdue, overdue);
  EXPECT_EQ(fleet.due_this_week, this_week);
  EXPECT_EQ(fleet.due_next_week, next_week);
  EXPECT_EQ(fleet.due_later, later);
  EXPECT_EQ(fleet.statuses.at(StatusWord::kDue), due);
  EXPECT_EQ(static_cast<std::int64_t>(later_rows.size()), later);
}

TEST_F(WorkListsTest, WhateverARowShowsIsSearched) {
  RobotSummary one = WarnedRobot("one", {"board_size panel larger"}), late = DueIn("late", -1);
  one.validity.calibrated_at = ParseIso("2026-01-31T12:00:00Z").value();
  one.last_session_at = ParseIso("2026-02-03T09:00:00Z").value();
  one.worst = WorstEdge{SensorId("left"), SensorId("mast"), 4.25};
  one.sessions = 12, one.edges = 59;
  late.verdict = {VerdictLevel::kPass, "All is well.", "Nothing."};
  Store({one, late});
  for (const char* words :
       {"ONE", "warning", "warn", "pairs failed", "show the board", "left mast", "panel larger", "31 Jan 2026",
        "2026-01-31", "1 May 2026", "2026-05-01", "3 feb", "12 sessions", "59 edges"})
    EXPECT_THAT(Searched(words), ElementsAre("one")) << words;
  EXPECT_THAT(Searched("revision 4"), ElementsAre("late", "one"));
  EXPECT_THAT(Searched("overdue"), ElementsAre("late"));
  EXPECT_THAT(Searched("pass overdue"), ElementsAre("late"));
  EXPECT_THAT(Searched("overdue warning"), IsEmpty());
  EXPECT_THAT(Searched("pass revision overdue late"), ElementsAre("late"));
}

TEST_F(WorkListsTest, AWholeListComesInItsOrder) {
  std::vector<RobotSummary> robots;
  for (int i = 0; i < 250; ++i) robots.push_back(WarnedRobot("r" + std::to_string(i), {"short_session"}));
  robots.push_back(WarnedRobot("other"));
  Store(robots);
  std::vector<std::string> names;
  const auto take = [&](const RobotSummary& row) { names.push_back(row.robot.str()); };
  ASSERT_TRUE(ForEachRobot(store_, {"", "", "robot", true, 2, "short_session"}, kWednesday, take));
  ASSERT_EQ(names.size(), 250u) << "whatever the page";
  EXPECT_EQ(names.front(), "r249");
  EXPECT_EQ(names.back(), "r0");
}

// As a revision keeps them for its robot's summary.
TEST_F(WorkListsTest, KeysOfARevisionComeBack) {
  ASSERT_TRUE(AppendRevision(store_, MakeRevision(1)));
  EXPECT_THAT(LoadCauseKeys(store_, {kRobot, 1}).value(), IsEmpty());
  ASSERT_TRUE(AppendCauseKeys(store_, {kRobot, 1}, {"short_session", "board_unseen rear"}));
  EXPECT_THAT(LoadCauseKeys(store_, {kRobot, 1}).value(), ElementsAre("board_unseen rear", "short_session"));
  EXPECT_THAT(LoadCauseKeys(store_, {kRobot, 2}).value(), IsEmpty());
}

// Of the version before causes were kept, with a robot whose summary was made.
std::string StoreWithoutCauses() {
  return EmptyStoreBefore("0018_causes.sql") +
         "INSERT INTO robot VALUES ('r', 1); DELETE FROM waiting_summary;"
         "INSERT INTO summary_robot (robot_id, changes, name_key, revision_number, verdict, sessions, edges, "
         "jobs_waiting, "
         "search, calculating, worst_frame_a, worst_frame_b, verdict_why, verdict_what_to_do, given_up) "
         "VALUES ('r', 1, 'r', 1, 'pass', 1, 1, 0, 'r pass', 0, '', '', 'All is well.', '', '');";
}

TEST(WorkListsMigration, RobotsOfBeforeWaitAndHaveNoCause) {
  const TempFolder folder;
  MakeDatabase(folder.path(), StoreWithoutCauses());
  Result<Store> store = Store::Open(folder.path());
  ASSERT_TRUE(store) << WordsOf(store);
  const auto listed = LoadSummaries(*store, RobotId(), std::nullopt, kWednesday);
  ASSERT_TRUE(listed && listed->size() == 1) << WordsOf(listed);
  EXPECT_THAT(listed->front().causes, IsEmpty());
  const auto waiting = LoadWaitingSummaries(*store, 9);
  ASSERT_TRUE(waiting && waiting->size() == 1) << WordsOf(waiting);
  ASSERT_TRUE(ReplaceSummary(*store, WarnedRobot("r", {"short_session"}), waiting->front().changes));
  EXPECT_EQ(LoadCauseCounts(*store, 9)->size(), 1u);
}

}  // namespace
}  // namespace rigcal::storage
