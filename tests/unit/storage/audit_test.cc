// The audit: every decision in one row, each row held by the hash of all before it. What was changed outside of rigcald
// is found and named.
#include "storage/audit.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>

#include "storage/revisions/decisions.h"
#include "storage/sessions/epochs.h"
#include "storage/sessions/retired.h"
#include "storage/settings/policies.h"
#include "tests/unit/storage/fixture.h"
#include "tests/unit/storage/old_store.h"

namespace rigcal::storage {
namespace {

constexpr Stamp kNoon{1'793'707'200'000'000'000};  // 3 Nov 2026, 12:00 UTC

class AuditTest : public StoreTest {
 protected:
  void AppendThree() {
    ASSERT_TRUE(AppendAudit(store_, kNoon, "Ada", "retired sensor top of robot mapper-01: taken off", kRobot));
    ASSERT_TRUE(AppendAudit(store_, {kNoon.ns + 1}, "Eve", "set version 1 of the policy of the fleet"));
    ASSERT_TRUE(AppendAudit(store_, {kNoon.ns + 2}, "Ada", "restored sensor top of robot mapper-01", kRobot));
  }
  void Tamper(const std::string& sql) { storage::TamperWith(place(), sql); }
  std::string Fault() {
    const auto check = VerifyAudit(store_);
    if (!check) return WordsOf(check);
    return check->fault ? TextOf(*check->fault) : "";
  }
};

TEST_F(AuditTest, TheChainHoldsAndItsHeadIsThatOfTheLastRow) {
  EXPECT_EQ(VerifyAudit(store_)->rows, 0);
  EXPECT_EQ(VerifyAudit(store_)->head.str(), kFirstAuditHash);
  AppendThree();
  const AuditCheck check = VerifyAudit(store_).value();
  EXPECT_FALSE(check.fault);
  EXPECT_EQ(check.rows, 3);
  EXPECT_EQ(check.head_number, 3);
  EXPECT_EQ(check.head, LoadAudit(store_, RobotId())->front().hash);
}

// Worked out here from the text that docs/approval.md tells, so that others can do it too.
TEST_F(AuditTest, AHashIsThatOfSixLines) {
  AppendThree();
  const std::vector<AuditRow> rows = LoadAudit(store_, RobotId()).value();
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[2].hash, Sha256Of(std::string(64, '0') + "\n1\n1793707200000000000\nmapper-01\nAda\n"
                                                          "retired sensor top of robot mapper-01: taken off"));
  EXPECT_EQ(rows[1].hash, Sha256Of(rows[2].hash->str() +
                                   "\n2\n1793707200000000001\n\nEve\nset version 1 of the policy of the fleet"));
}

TEST_F(AuditTest, AChangedRowIsNamedWhicheverColumnItWas) {
  AppendThree();
  for (const char* change : {"audit SET what = 'retired sensor tap' || substr(what, 19)", "audit SET who = 'Adb'",
                             "audit SET at_ns = at_ns + 1", "audit_chain SET robot_id = 'mapper-02'",
                             "audit_chain SET hash = 'f' || substr(hash, 2)"}) {
    const std::string columns = std::string("UPDATE ") + change + " WHERE number = 2";
    Tamper("CREATE TABLE kept AS SELECT * FROM audit; CREATE TABLE kept_chain AS SELECT * FROM audit_chain;" + columns);
    EXPECT_EQ(Fault(), "audit row 2 of 3 Nov 2026 was changed, or one before it is missing") << change;
    EXPECT_EQ(VerifyAudit(store_)->rows, 1) << change;
    Tamper(
        "DELETE FROM audit; DELETE FROM audit_chain; INSERT INTO audit SELECT * FROM kept; INSERT INTO audit_chain "
        "SELECT * FROM kept_chain; DROP TABLE kept; DROP TABLE kept_chain;");
    EXPECT_EQ(Fault(), "") << change;
  }
}

TEST_F(AuditTest, ARowThatIsMissingOrWasPutInIsNamed) {
  AppendThree();
  Tamper("DELETE FROM audit WHERE number = 2");
  EXPECT_EQ(Fault(), "audit row 2 is missing");
  Tamper("DELETE FROM audit_chain WHERE number = 2");
  EXPECT_EQ(Fault(), "audit row 3 of 3 Nov 2026 was changed, or one before it is missing");
  Tamper("INSERT INTO audit VALUES (2, 1793707200000000001, 'Eve', 'nothing')");
  EXPECT_EQ(Fault(), "audit row 2 of 3 Nov 2026 has no hash: rigcald did not write it");
}

// Whoever cuts the end is not found by the chain; the head that was kept elsewhere is another one.
TEST_F(AuditTest, ACutEndIsSeenByTheHeadAlone) {
  AppendThree();
  const Digest head = VerifyAudit(store_)->head;
  Tamper("DELETE FROM audit WHERE number = 3; DELETE FROM audit_chain WHERE number = 3");
  EXPECT_EQ(Fault(), "");
  EXPECT_NE(VerifyAudit(store_)->head, head);
  Tamper("DELETE FROM audit WHERE number = 2");
  ASSERT_TRUE(AppendAudit(store_, kNoon, "Ada", "goes on"));
  EXPECT_EQ(LoadAudit(store_, RobotId(), 0, 1)->front().number, 3);
  EXPECT_EQ(Fault(), "audit row 2 is missing");
}

TEST_F(AuditTest, ListsByPagesAndByRobot) {
  AppendThree();
  const auto numbers = [&](const RobotId& robot, std::int64_t before, std::int64_t limit) {
    std::vector<std::int64_t> found;
    const auto rows = LoadAudit(store_, robot, before, limit);
    EXPECT_TRUE(rows) << WordsOf(rows);
    for (const AuditRow& row : *rows) found.push_back(row.number);
    return found;
  };
  EXPECT_THAT(numbers(RobotId(), 0, 2), testing::ElementsAre(3, 2));
  EXPECT_THAT(numbers(RobotId(), 2, 2), testing::ElementsAre(1));
  EXPECT_THAT(numbers(kRobot, 0, kAllRows), testing::ElementsAre(3, 1));
  EXPECT_THAT(numbers(kRobot, 3, 1), testing::ElementsAre(1));
  EXPECT_TRUE(LoadAudit(store_, RobotId("nobody"))->empty());
}

TEST_F(AuditTest, WhatAWriteGivesUpIsInNoRow) {
  EXPECT_FALSE(store_.Write([&]() -> Status {
    RIGCAL_TRY(AppendAudit(store_, kNoon, "Ada", "nothing"));
    return Fail(ErrorCode::kConflict, "no", "no");
  }));
  EXPECT_TRUE(LoadAudit(store_, RobotId())->empty());
  ASSERT_TRUE(AppendPolicy(store_, {PolicyScope::kRobot, kRobot.str()}, "max_age_days: 9", {kNoon, "Ada", "short"}));
  EXPECT_EQ(LoadAudit(store_, kRobot)->front().number, 1);
  EXPECT_EQ(Fault(), "");
}

// What decides is in other tables: each row of them is held by its audit row.
class HeldRowsTest : public AuditTest {
 protected:
  void SetUp() override {
    ASSERT_TRUE(AppendEdge(store_, MakeEdge(1), {1}));
    for (int i = 0; i < 2; ++i) ASSERT_TRUE(AppendRevision(store_, MakeRevision(1)));
    ASSERT_TRUE(AppendPolicy(store_, {}, "approval: person\n", {kNoon, "Eve", "people ride on it"}));
    ASSERT_TRUE(AppendDecision(store_, kRobot, 1, Deciding::kApprove, {kNoon, "Ada", "checked"}));
    ASSERT_TRUE(RetireEdge(store_, MakeEdge(1).id, {kNoon, "Ada", "typed wrong"}));
    ASSERT_TRUE(Holds(VerifyAudit(store_).value()));
  }
  std::vector<std::string> RowFaults() {
    std::vector<std::string> texts;
    const AuditCheck check = VerifyAudit(store_).value();
    EXPECT_FALSE(check.fault) << "the chain itself holds";
    EXPECT_EQ(check.row_faults_count, static_cast<std::int64_t>(check.row_faults.size()));
    for (const AuditFault& fault : check.row_faults) texts.push_back(TextOf(fault));
    return texts;
  }
};

TEST_F(HeldRowsTest, ADecisionThatWasPutInIsNamed) {
  Tamper(
      "INSERT INTO decision (number, robot_id, revision_number, how, at_ns, who, reason) VALUES (2, 'mapper-01', 2, "
      "'approved', 5, 'policy', 'the verdict is pass')");
  EXPECT_THAT(RowFaults(), testing::ElementsAre("decision 2 (approved revision 2 of robot mapper-01, by policy) has no "
                                                "audit row: rigcald did not write it"));
}

TEST_F(HeldRowsTest, AChangedPolicyAndAMissingStandingAreNamed) {
  Tamper("UPDATE policy SET text = 'approval: automatic'; DELETE FROM standing WHERE how = 'retired'");
  EXPECT_THAT(RowFaults(),
              testing::ElementsAre("policy 1 (version 1 of the fleet, by Eve) was changed since audit row 1 of 3 Nov "
                                   "2026 was written about it",
                                   "standing 1, which audit row 3 of 3 Nov 2026 is about, is missing"));
}

TEST_F(HeldRowsTest, EachColumnOfADecisionIsHeld) {
  for (const char* change : {"robot_id = 'mapper-02'", "revision_number = 2", "how = 'rejected'", "at_ns = 4",
                             "who = 'Adb'", "reason = ''", "edge_watermark = 0"}) {
    Tamper(std::string("CREATE TABLE kept AS SELECT * FROM decision; UPDATE decision SET ") + change);
    EXPECT_THAT(RowFaults(), testing::Contains(testing::HasSubstr("decision 1 ("))) << change;
    Tamper("DELETE FROM decision; INSERT INTO decision SELECT * FROM kept; DROP TABLE kept");
    EXPECT_TRUE(RowFaults().empty()) << change;
  }
}

// One audit row for each sensor, also where they were named together; and the time from which it counts is held.
TEST_F(HeldRowsTest, AnEpochThatAPersonBeganIsHeldWithItsTime) {
  const std::vector<SensorId> sensors = {SensorId("left"), SensorId("right")};
  ASSERT_TRUE(BeginEpoch(store_, kRobot, sensors, {kNoon.ns - 9}, {kNoon, "Ada", "new mast"}));
  ASSERT_TRUE(TakeBackEpoch(store_, kRobot, {sensors[1]}, {kNoon, "Ada", "not the right one"}));
  EXPECT_TRUE(Holds(VerifyAudit(store_).value()));
  EXPECT_EQ(RowFaults(), std::vector<std::string>());
  Tamper("UPDATE epoch SET begins_ns = 5 WHERE standing_number = 2");
  EXPECT_THAT(RowFaults(), testing::ElementsAre(testing::HasSubstr(
                               "standing 2 (epoch sensor left of robot mapper-01, by Ada) was changed")));
}

// Whoever puts in the row that holds it as well is found by the chain.
TEST_F(HeldRowsTest, WhatHoldsARowIsHeldByTheChain) {
  Tamper("UPDATE audit_row SET hash = 'f' || substr(hash, 2) WHERE number = 2");
  EXPECT_EQ(Fault(), "audit row 2 of 3 Nov 2026 was changed, or one before it is missing");
  Tamper("DELETE FROM audit_row WHERE number = 2");
  EXPECT_EQ(Fault(), "audit row 2 of 3 Nov 2026 was changed, or one before it is missing");
}

// That a session came whole nobody decided, once.
TEST_F(HeldRowsTest, ASessionThatCameWholeNeedsNoAuditRow) {
  const SessionId session = AppendClosedSession(store_, 2, {});
  EXPECT_TRUE(Holds(VerifyAudit(store_).value()));
  Tamper(
      "INSERT INTO standing (number, robot_id, at_ns, how, session_number, who, reason) SELECT 3, robot_id, 9, "
      "'pushed', "
      "number, 'robot ' || robot_id, '' FROM session WHERE session_id = '" +
      session.str() + "'");
  EXPECT_EQ(RowFaults().size(), 1u);
}

TEST_F(HeldRowsTest, ADamagedNumberIsAnErrorWithACure) {
  Tamper("INSERT INTO audit VALUES (9223372036854775807, 1, 'x', 'y')");
  const Status appended = AppendAudit(store_, kNoon, "Ada", "goes on");
  ASSERT_FALSE(appended);
  EXPECT_EQ(appended.error().code, ErrorCode::kStorage);
  EXPECT_THAT(appended.error().what, testing::HasSubstr("the audit is damaged"));
  EXPECT_THAT(appended.error().cure, testing::HasSubstr("rigcal audit verify"));
  EXPECT_FALSE(CheckAuditGoesOn(store_));
  EXPECT_EQ(Fault(), "audit row 9223372036854775807 of 1 Jan 1970 has no hash: rigcald did not write it");
}

// Version 21: rows without hashes; the robot is read from their words, where it is one.
TEST(AuditMigration, RowsOfVersion21AreChainedOnceAndAlike) {
  std::string sql = EmptyStoreOfVersion(21);
  sql +=
      "INSERT INTO robot VALUES ('mapper-01', 1);"
      "INSERT INTO audit VALUES (1, 5, 'Ada', 'retired sensor top of robot mapper-01: of robot b'),"
      "(2, 6, 'Eve', 'set version 1 of the policy of rig model robot b: x'), (4, 7, 'Eve', 'restored session s of "
      "robot b, retired')";
  std::vector<Digest> heads;
  for (int time = 0; time < 2; ++time) {
    const TempFolder folder;
    MakeDatabase(folder.path(), sql);
    Result<Store> store = Store::Open(folder.path());
    ASSERT_TRUE(store) << WordsOf(store);
    const AuditCheck check = VerifyAudit(*store).value();
    EXPECT_FALSE(check.fault);
    EXPECT_EQ(check.rows, 3);
    heads.push_back(check.head);
    const std::vector<AuditRow> rows = LoadAudit(*store, RobotId("mapper-01")).value();
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows.front().number, 1);
    ASSERT_TRUE(AppendAudit(*store, {9}, "Ada", "goes on"));
    EXPECT_EQ(VerifyAudit(*store)->head_number, 5);
    EXPECT_FALSE(VerifyAudit(*store)->fault);
  }
  EXPECT_EQ(heads[0], heads[1]);
}

// Rows of before are held together from the migration on, and told as such.
TEST(AuditMigration, RowsThatDecideFromBeforeAreHeldTogether) {
  std::string sql = EmptyStoreBefore("0030_held_decisions.sql");
  sql +=
      "INSERT INTO robot VALUES ('mapper-01', 1); INSERT INTO policy VALUES (1, 'fleet', '', 1, 5, 'Eve', 'x', "
      "'approval: person'); INSERT INTO standing VALUES (1, 'mapper-01', 5, 'retired', NULL, NULL, 'top', 'Ada', "
      "'off')";
  const TempFolder folder;
  const std::string file = (folder.path() / "rigcal.db").string();
  { SQLite::Database(file, SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE).exec(sql); }
  Result<Store> store = Store::Open(folder.path());
  ASSERT_TRUE(store) << WordsOf(store);
  AuditCheck check = VerifyAudit(*store).value();
  EXPECT_TRUE(Holds(check)) << (check.row_faults.empty() ? "" : TextOf(check.row_faults.front()));
  EXPECT_EQ(check.from_before, 2);
  EXPECT_EQ(check.rows, 2) << "one audit row for each kind";
  EXPECT_EQ(LoadAudit(*store, RobotId())->front().who, kServerWho);
  SQLite::Database(file, SQLite::OPEN_READWRITE, 0, SummingFiles())
      .exec("DROP TRIGGER policy_no_update; UPDATE policy SET text = 'approval: automatic'");
  check = VerifyAudit(*store).value();
  ASSERT_EQ(check.row_faults.size(), 1u);
  EXPECT_THAT(TextOf(check.row_faults.front()),
              testing::HasSubstr("one of the policies up to number 1, from before audit row 2"));
}

}  // namespace
}  // namespace rigcal::storage
