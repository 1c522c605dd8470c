// What was decided about is held, not its number alone: document and poses of revisions, rig models, boards.
#include <gmock/gmock.h>

#include "storage/audit.h"
#include "storage/audited_rows.h"
#include "storage/boards/measures.h"
#include "storage/revisions/decisions.h"
#include "storage/revisions/revision_poses.h"
#include "storage/settings/rig_models.h"
#include "tests/unit/storage/fixture.h"
#include "tests/unit/storage/old_store.h"

namespace rigcal::storage {
namespace {

using testing::ElementsAre;

constexpr Stamp kDecidedAt{1'793'707'200'000'000'000};  // 3 Nov 2026, 12:00 UTC
const Word kChecked{kDecidedAt, "Ada", "checked"};
const std::string kOfRevision =
    " of revision 1 of robot mapper-01 was changed since audit row 1 of 3 Nov 2026 was "
    "written about it";

std::vector<std::string> FaultsOf(Store& store) {
  const auto check = VerifyAudit(store);
  if (!check) return {WordsOf(check)};
  std::vector<std::string> texts;
  if (check->fault) texts.push_back("the chain: " + TextOf(*check->fault));
  for (const AuditFault& fault : check->row_faults) texts.push_back(TextOf(fault));
  return texts;
}

BoardMeasure BoardOfAda() {
  BoardMeasure measure;
  measure.serial = "B-7", measure.pattern = {TargetKind::kCheckerboard, 9, 6, 0.025};
  measure.length_x_m = 0.2, measure.length_y_m = 0.15, measure.measured_x_m = 0.1996, measure.measured_y_m = 0.1497;
  measure.sigma_m = 1e-5;
  measure.word = kChecked;
  return measure;
}

class HeldContentTest : public StoreTest {
 protected:
  void SetUp() override {
    ASSERT_TRUE(AppendEdge(store_, MakeEdge(1), {1}));
    ASSERT_TRUE(AppendRevision(store_, MakeRevision(1)));
    JointPoses poses;
    poses.reference = kLeft;
    poses.T_ref_sensor = {{kLeft, {}}, {kRight, Se3{{0.25, 1.0 / 3.0, -0.01}, Eigen::Quaterniond(0.8, 0.0, 0.6, 0.0)}}};
    poses.covariances = {{{kRight}, 1e-6 * Eigen::MatrixXd::Identity(6, 6)}};
    ASSERT_TRUE(AppendRevisionPoses(store_, {kRobot, 1}, poses));
    ASSERT_TRUE(AppendDecision(store_, kRobot, 1, Deciding::kApprove, kChecked).value());
    EXPECT_THAT(FaultsOf(store_), ElementsAre());
    EXPECT_EQ(VerifyAudit(store_)->without_digest, 0);
  }
  void Tamper(const std::string& sql) { storage::TamperWith(place(), sql); }
};

TEST_F(HeldContentTest, TheListTellsTheDigestOfWhatWasDecidedAbout) {
  ASSERT_TRUE(AppendRigModel(store_, "mars", "rig_model: mars", kChecked));
  ASSERT_TRUE(AppendDecision(store_, kRobot, 1, Deciding::kReject, kChecked).value());
  const Digest digest = LoadRevision(store_, kRobot, 1).value()->digest;
  std::vector<std::optional<Digest>> told;
  const std::vector<AuditRow> rows = LoadAudit(store_, RobotId()).value();
  for (const AuditRow& row : rows) told.push_back(row.digest);
  EXPECT_THAT(told, ElementsAre(digest, std::nullopt, digest));
  EXPECT_EQ(LoadAudit(store_, kRobot, 3, 1)->front().digest, digest);
}

// SQLite keeps no sign of a zero, PostgreSQL does: a store that moves from one to the other holds.
TEST(HeldNumber, BothZerosAreOne) {
  EXPECT_EQ(HeldNumber(-0.0), "0");
  EXPECT_EQ(HeldNumber(-1e-05), "-1e-05");
}

// What somebody would do who knows how the document is checked.
TEST_F(HeldContentTest, AnotherDocumentWithItsDigestIsNamed) {
  const std::string other = "{\"sensors\":[2]}";
  Tamper("DELETE FROM revision_document; UPDATE revision SET document = '" + other + "', digest = '" +
         DigestOf(other).str() + "'");
  ASSERT_EQ(LoadRevision(store_, kRobot, 1).value()->document, other);
  EXPECT_THAT(FaultsOf(store_), ElementsAre("the document" + kOfRevision));
}

TEST_F(HeldContentTest, EachPartOfWhatWasApprovedIsHeld) {
  const auto told = [&](const std::string& table, const std::string& change) {
    Tamper("CREATE TABLE kept AS SELECT * FROM " + table + "; " + change);
    const auto faults = FaultsOf(store_);
    Tamper("DELETE FROM " + table + "; INSERT INTO " + table + " SELECT * FROM kept; DROP TABLE kept");
    EXPECT_THAT(FaultsOf(store_), ElementsAre()) << change;
    return faults;
  };
  EXPECT_THAT(told("revision", "UPDATE revision SET digest = '" + std::string(64, 'a') + "'"),
              ElementsAre("the digest" + kOfRevision));
  EXPECT_THAT(told("revision_document", "DELETE FROM revision_document"), ElementsAre("the document" + kOfRevision));
  for (const char* change :
       {"revision_pose SET T_ref_sensor_x_m = T_ref_sensor_x_m + 0.05 WHERE sensor_id = 'right'",
        "revision_pose SET T_ref_sensor_qw = -0.8 WHERE sensor_id = 'right'",
        "revision_pose SET is_reference = 1 - is_reference", "revision_covariance SET sensors = 'left'"})
    EXPECT_THAT(told(std::string(change).substr(0, std::string(change).find(' ')), std::string("UPDATE ") + change),
                ElementsAre("a pose" + kOfRevision))
        << change;
  EXPECT_THAT(
      told("decision", "UPDATE decision SET digest = NULL, poses_hash = NULL"),
      ElementsAre("decision 1 (approved revision 1 of robot mapper-01, by Ada) was changed since audit row 1 of 3 "
                  "Nov 2026 was written about it"));
}

TEST_F(HeldContentTest, ARevisionThatIsGoneIsNamed) {
  Tamper("DELETE FROM revision");
  EXPECT_THAT(FaultsOf(store_),
              ElementsAre("revision 1 of robot mapper-01, which audit row 1 of 3 Nov 2026 is about, is missing"));
}

TEST_F(HeldContentTest, AChangedRigModelIsNamed) {
  ASSERT_TRUE(AppendRigModel(store_, "mars", "rig_model: mars", kChecked));
  EXPECT_THAT(FaultsOf(store_), ElementsAre());
  Tamper("UPDATE rig_model SET text = 'rig_model: moon'");
  EXPECT_THAT(FaultsOf(store_),
              ElementsAre("rig model 1 (version 1 of mars, by Ada) was changed since audit row 2 of 3 "
                          "Nov 2026 was written about it"));
  Tamper("DELETE FROM rig_model");
  EXPECT_THAT(FaultsOf(store_), ElementsAre("rig model 1, which audit row 2 of 3 Nov 2026 is about, is missing"));
}

TEST_F(HeldContentTest, EachNumberOfABoardIsHeld) {
  ASSERT_TRUE(AppendBoardMeasure(store_, BoardOfAda()));
  EXPECT_THAT(FaultsOf(store_), ElementsAre());
  for (const char* change :
       {"serial = 'B-8'", "kind = 'charuco'", "col_count = 8", "row_count = 5", "square_m = 0.026", "length_x_m = 0.3",
        "length_y_m = 0.3", "measured_x_m = 0.199600000000001", "measured_y_m = 0.1498", "sigma_m = 0.00002",
        "sigma_is_assumed = 1", "flatness_m = 0.001", "next_check_ns = 5", "at_ns = 5", "who = 'Eve'", "reason = ''"}) {
    Tamper(std::string("CREATE TABLE kept AS SELECT * FROM board_measure; UPDATE board_measure SET ") + change);
    EXPECT_EQ(FaultsOf(store_).size(), 1u) << change;
    Tamper("DELETE FROM board_measure; INSERT INTO board_measure SELECT * FROM kept; DROP TABLE kept");
    EXPECT_THAT(FaultsOf(store_), ElementsAre()) << change;
  }
  // As docs/approval.md has it, so that others can work it out.
  EXPECT_EQ(TextIn(store_, "SELECT hash FROM audit_row WHERE kind = 'board_measure'"),
            Sha256Of("board_measure\n1\nB-7\ncheckerboard\n9\n6\n0\n\n1793707200000000000\nAda\nchecked\n0.025\n0.2\n"
                     "0.15\n0.1996\n0.1497\n1e-05\n")
                .str());
}

// Decisions of before hold no digest, and are verified as they were; rig models and boards of before are held together.
TEST(HeldContentMigration, WhatIsFromBeforeStaysAsItIs) {
  const TempFolder folder;
  const std::string document = "{\"sensors\":[]}";
  std::string sql = EmptyStoreBefore("0050_held_digests.sql");
  sql +=
      "INSERT INTO robot VALUES ('mapper-01', 1); INSERT INTO revision VALUES ('mapper-01', 1, 5, 0, 'pass', 'why', "
      "'do', '" +
      DigestOf(document).str() + "', '" + document +
      "'); INSERT INTO decision (robot_id, revision_number, how, at_ns, who, reason) VALUES ('mapper-01', 1, "
      "'approved', 7, 'Ada', 'x'); INSERT INTO audit VALUES (1, 7, 'Ada', 'y'); INSERT INTO rig_model VALUES (1, "
      "'mars', 1, 5, 'Eve', 'x', 'rig_model: mars'); INSERT INTO board_measure VALUES (1, 'B-7', 'charuco', 10, 7, "
      "0.03, 0.3, 0.2, 0.2992, 0.1996, 0.0002, 1, NULL, NULL, 5, 'Ada', '');";
  AuditRow row{1, {7}, {}, "Ada", "y"};
  row.holds = HeldRow{"decision", 1, Sha256Of("decision\n1\nmapper-01\n1\napproved\n7\nAda\nx\n0")};
  sql += "INSERT INTO audit_row VALUES (1, 'decision', 1, '" + row.holds->hash.str() +
         "'); INSERT INTO audit_chain VALUES (1, NULL, '" + AuditHash(Digest(kFirstAuditHash), row).str() + "');";
  MakeDatabase(folder.path(), sql);
  Result<Store> store = Store::Open(folder.path());
  ASSERT_TRUE(store) << WordsOf(store);
  EXPECT_THAT(FaultsOf(*store), ElementsAre());
  const AuditCheck check = VerifyAudit(*store).value();
  EXPECT_EQ(check.without_digest, 1);
  EXPECT_EQ(check.from_before, 2);
  EXPECT_EQ(check.rows, 3) << "one more for each kind that is held from here on";
  ASSERT_TRUE(AppendDecision(*store, kRobot, 1, Deciding::kReject, kChecked).value());
  EXPECT_EQ(VerifyAudit(*store)->without_digest, 1) << "later ones hold theirs";
  EXPECT_THAT(FaultsOf(*store), ElementsAre());
  TamperWith({folder.path()}, "UPDATE revision SET document = '{}'; UPDATE rig_model SET name = 'moon'");
  EXPECT_EQ(FaultsOf(*store).size(), 3u) << "the document, of both decisions, and the rig models of before";
}

}  // namespace
}  // namespace rigcal::storage
