// The audit: every decision in one row, each row held by the hash of all before it. What was changed outside of rigcald
// is found and named.
#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>

#include "server/base/durable_file.h"
#include "storage/audit.h"
#include "storage/policies.h"
#include "tests/unit/storage_fixture.h"

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
  // As somebody would who can write to the file.
  void Tamper(const std::string& sql) {
    SQLite::Database file((folder_.path() / "rigcal.db").string(), SQLite::OPEN_READWRITE);
    for (const char* table : {"audit", "audit_chain"})
      for (const char* what : {"_no_update", "_no_delete"})
        file.exec(std::string("DROP TRIGGER IF EXISTS ") + table + what);
    file.exec("PRAGMA foreign_keys = OFF; " + sql);
  }
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

// Version 21: rows without hashes; the robot is read from their words, where it is one.
TEST(AuditMigration, RowsOfVersion21AreChainedOnceAndAlike) {
  std::string sql;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(RIGCAL_SOURCE_DIR "/storage/schema"))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (std::size_t i = 0; i < 21; ++i) sql += ReadFile(files[i], 1 << 20).value();
  sql +=
      "PRAGMA application_id = 1382499180; PRAGMA user_version = 21; INSERT INTO robot VALUES ('mapper-01', 1);"
      "INSERT INTO audit VALUES (1, 5, 'Ada', 'retired sensor top of robot mapper-01: of robot b'),"
      "(2, 6, 'Eve', 'set version 1 of the policy of rig model robot b: x'), (4, 7, 'Eve', 'restored session s of "
      "robot b, retired')";
  std::vector<Digest> heads;
  for (int time = 0; time < 2; ++time) {
    const TempFolder folder;
    {
      SQLite::Database((folder.path() / "rigcal.db").string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE).exec(sql);
    }
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

}  // namespace
}  // namespace rigcal::storage
