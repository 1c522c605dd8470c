// The list of all robots by rig model, site, operator and the day on which each is due.
#include <gmock/gmock.h>

#include "storage/fleet/fleet_list.h"
#include "storage/fleet/robot_summary.h"
#include "tests/unit/storage/fixture.h"
#include "tests/unit/storage/old_store.h"

namespace rigcal::storage {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr Stamp kListedAt{1000 * kDay_ns};

RobotSummary RobotOfModel(const std::string& name, const std::string& model = "", const std::string& site = "",
                          const std::string& operator_name = "") {
  RobotSummary summary;
  summary.robot = RobotId(name);
  summary.revision = 1;
  summary.verdict = {VerdictLevel::kPass, "All is well.", ""};
  summary.validity.calibrated_at = Stamp{kListedAt.ns - kDay_ns};
  summary.validity.usable = UsableRevision{1, {}};
  summary.rig_model = model, summary.site = site, summary.operator_name = operator_name;
  return summary;
}

class FleetColumnsTest : public StoreTest {
 protected:
  void Keep(const std::vector<RobotSummary>& robots) {
    ASSERT_TRUE(store_.Write([&]() -> Status {
      for (const RobotSummary& summary : robots) {
        RIGCAL_TRY(AppendRobot(store_, summary.robot, {1}));
        RIGCAL_TRY(ReplaceSummary(store_, summary, 1));
      }
      return {};
    }));
  }
  std::vector<std::string> Names(const FleetQuery& asked) {
    std::vector<std::string> names;
    const auto page = LoadFleetPage(store_, asked, kListedAt);
    EXPECT_TRUE(page) << WordsOf(page);
    if (page)
      for (const RobotSummary& row : page->rows) names.push_back(row.robot.str());
    return names;
  }
  std::vector<std::string> Sorted(const std::string& sort, bool descending) {
    return Names({"", "", sort, descending});
  }
};

TEST_F(FleetColumnsTest, NamesAreSortedAndWhoHasNoneComesLastEitherWay) {
  Keep({RobotOfModel("a", "rover", "Hall 2", "Bo"), RobotOfModel("b", "", "", ""),
        RobotOfModel("c", "Arm", "hall 1", "ada")});
  for (const char* sort : {"model", "site", "operator"}) {
    EXPECT_THAT(Sorted(sort, false), ElementsAre("c", "a", "b")) << sort;
    EXPECT_THAT(Sorted(sort, true), ElementsAre("a", "c", "b")) << sort;
  }
}

TEST_F(FleetColumnsTest, DueIsByAgeOrByDriftWhicheverIsEarlier) {
  std::vector<RobotSummary> robots = {RobotOfModel("by-age"), RobotOfModel("by-drift"), RobotOfModel("late-drift"),
                                      RobotOfModel("never"), RobotOfModel("short")};
  robots[1].drift_due = DriftDue{SensorId("mast"), Stamp{kListedAt.ns + 5 * kDay_ns}};
  robots[2].validity.calibrated_at = Stamp{kListedAt.ns - 2 * kDay_ns};
  robots[2].drift_due = DriftDue{SensorId("mast"), Stamp{kListedAt.ns + 900 * kDay_ns}};
  robots[3].validity.calibrated_at.reset();
  robots[4].validity.max_age_ns = 7 * kDay_ns;
  Keep(robots);
  EXPECT_THAT(Sorted("due", false), ElementsAre("by-drift", "short", "late-drift", "by-age", "never"));
  EXPECT_THAT(Sorted("due", true), ElementsAre("by-age", "late-drift", "short", "by-drift", "never"));
}

TEST_F(FleetColumnsTest, AreSearched) {
  RobotSummary a = RobotOfModel("a", "mars-mapper", "Hall 3", "Ada Lovelace");
  a.drift_due = DriftDue{SensorId("mast"), ParseIso("1972-10-05").value()};
  Keep({a, RobotOfModel("b", "mars-rover", "Hall 4", "Bo")});
  for (const char* words : {"MAPPER", "hall 3", "lovelace", "ada mars", "drift mast", "5 oct 1972", "1972-10-05"})
    EXPECT_THAT(Names({words, "", ""}), ElementsAre("a")) << words;
  EXPECT_THAT(Names({"mars", "", ""}), ElementsAre("a", "b"));
  EXPECT_THAT(Names({"mapper bo", "", ""}), IsEmpty());
  RobotSummary bad = RobotOfModel("c");
  bad.verdict.level = VerdictLevel::kFail;
  Keep({bad});
  for (const char* words : {"failed", "do not drive", "DRIVE"})
    EXPECT_THAT(Names({words, "", ""}), ElementsAre("c")) << words;
}

TEST_F(FleetColumnsTest, AModelIsChosenWholeOrWhatIsToBeLookedAtOfIt) {
  RobotSummary bad = RobotOfModel("bad", "mars");
  bad.verdict.level = VerdictLevel::kFail;
  RobotSummary warned = RobotOfModel("warned", "mars");  // may drive, with something to mend
  warned.verdict.level = VerdictLevel::kWarn;
  Keep({bad, warned, RobotOfModel("good", "mars"), RobotOfModel("other", "mars-2"), RobotOfModel("none")});
  EXPECT_THAT(Names({"", "", "robot", false, 1, "", "", "", "mars"}), ElementsAre("bad", "good", "warned"));
  EXPECT_THAT(Names({"", "", "robot", false, 1, "", kStatusWithWork, "", "mars"}), ElementsAre("bad", "warned"));
  EXPECT_THAT(Names({"", "", "robot", false, 1, "", kStatusWithWork}), ElementsAre("bad", "warned"));
  EXPECT_EQ(CountFleet(store_, kListedAt)->models.front().with_work, 2);
  EXPECT_THAT(Names({"good", "", "robot", false, 1, "", "", "", "mars"}), ElementsAre("good")) << "with words, too";
  EXPECT_THAT(Names({"", "", "robot", false, 1, "", "", "", "mar"}), IsEmpty());
}

TEST_F(FleetColumnsTest, ModelsWithTheMostWorkComeFirst) {
  std::vector<RobotSummary> robots = {RobotOfModel("n1"), RobotOfModel("s1", "still", "hall", "Ada"),
                                      RobotOfModel("s2", "still"), RobotOfModel("s3", "still")};
  for (const char* name : {"m1", "m2", "t1", "t2", "t3"})
    robots.push_back(RobotOfModel(name, name[0] == 'm' ? "mars" : "terra"));
  robots[4].verdict.level = VerdictLevel::kFail;     // of mars one of two
  robots[6].verdict.level = VerdictLevel::kUnknown;  // of terra one of three
  robots[0].verdict.level = VerdictLevel::kFail;     // of no model
  Keep(robots);
  const FleetCounts fleet = CountFleet(store_, kListedAt).value();
  std::string told;
  for (const ModelCount& model : fleet.models)
    told += model.rig_model + " " + std::to_string(model.with_work) + "/" + std::to_string(model.robots) + " ";
  EXPECT_EQ(told, "terra 1/3 mars 1/2 still 0/3 ");
  EXPECT_EQ(fleet.with_site, 1);
  EXPECT_EQ(fleet.with_operator, 1);
  EXPECT_EQ(fleet.statuses.at(StatusWord::kFailed), 2);
  EXPECT_EQ(fleet.statuses.at(StatusWord::kOk), 6);
  EXPECT_EQ(fleet.statuses.at(StatusWord::kDrifted), 0);
}

TEST_F(FleetColumnsTest, AsManyModelsAreToldAsAListShowsAndOneMore) {
  std::vector<RobotSummary> robots;
  for (int i = 0; i < 40; ++i) robots.push_back(RobotOfModel("r" + std::to_string(i), "model-" + std::to_string(i)));
  Keep(robots);
  EXPECT_EQ(CountFleet(store_, kListedAt)->models.size(), kModelsListedMax + 1);
}

// Of the version before these columns, with a robot whose summary was made, and a session of it.
std::string StoreWithoutColumns() {
  return EmptyStoreBefore("0034_fleet_columns.sql") +
         "INSERT INTO robot VALUES ('r', 1); DELETE FROM waiting_summary;"
         "INSERT INTO summary_robot (robot_id, changes, name_key, revision_number, verdict, sessions, edges, "
         "jobs_waiting, "
         "search, calculating, worst_frame_a, worst_frame_b, verdict_why, verdict_what_to_do, given_up, causes, site) "
         "VALUES ('r', 1, 'r', 1, 'pass', 1, 1, 0, 'r pass', 0, '', '', 'All is well.', '', '', '[]', 'hall 3');";
}

TEST(FleetColumnsMigration, RobotsOfBeforeKeepTheirRowAndWait) {
  const TempFolder folder;
  MakeDatabase(folder.path(), StoreWithoutColumns());
  Result<Store> store = Store::Open(folder.path());
  ASSERT_TRUE(store) << WordsOf(store);
  const auto listed = LoadSummaries(*store, RobotId(), std::nullopt, kListedAt);
  ASSERT_TRUE(listed && listed->size() == 1) << WordsOf(listed);
  EXPECT_EQ(listed->front().site, "hall 3");
  EXPECT_EQ(listed->front().rig_model, "");
  EXPECT_THAT(listed->front().calibrations, IsEmpty());
  const auto waiting = LoadWaitingSummaries(*store, 9);
  ASSERT_TRUE(waiting && waiting->size() == 1) << WordsOf(waiting);
  ASSERT_TRUE(ReplaceSummary(*store, RobotOfModel("r", "mars"), waiting->front().changes));
  EXPECT_EQ(LoadSummaries(*store, RobotId(), std::nullopt, kListedAt)->front().rig_model, "mars");
}

}  // namespace
}  // namespace rigcal::storage
