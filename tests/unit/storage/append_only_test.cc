// No statement changes or removes what is stored, in any table but the queues, and those that follow from the others.
#include "server/formats/documents.h"
#include "storage/access/access_tokens.h"
#include "storage/access/accounts.h"
#include "storage/alerts/outbox.h"
#include "storage/alerts/revision_status.h"
#include "storage/audit.h"
#include "storage/boards/measures.h"
#include "storage/database/query.h"
#include "storage/files/lost_blobs.h"
#include "storage/fleet/fleet_facts.h"
#include "storage/fleet/robot_runs.h"
#include "storage/fleet/robot_status.h"
#include "storage/fleet/robot_summary.h"
#include "storage/revisions/as_found.h"
#include "storage/revisions/decisions.h"
#include "storage/revisions/merged_edges.h"
#include "storage/revisions/revision_poses.h"
#include "storage/sessions/epochs.h"
#include "storage/sessions/retired.h"
#include "storage/sessions/session_estimates.h"
#include "storage/settings/policies.h"
#include "storage/settings/rig_models.h"
#include "storage/work/attempts.h"
#include "storage/work/recomputations.h"
#include "tests/unit/storage/fixture.h"

namespace rigcal::storage {
namespace {

// What tells of the tables and their columns, in either engine.
const std::string kTables = IsOnSqlite()
                                ? "SELECT name FROM sqlite_schema WHERE type = 'table' AND name NOT LIKE 'sqlite%'"
                                : "SELECT CAST(tablename AS TEXT) AS name FROM pg_tables WHERE schemaname = 'rigcal' "
                                  "AND tablename <> 'schema_version'";
const std::string kRealColumns =
    IsOnSqlite()
        ? "SELECT m.name || '.' || c.name FROM sqlite_schema m JOIN pragma_table_info(m.name) c WHERE m.type = 'table' "
          "AND c.type = 'REAL'"
        : "SELECT table_name || '.' || column_name FROM information_schema.columns WHERE table_schema = 'rigcal' AND "
          "data_type = 'double precision'";

std::string FirstColumnOf(Store& store, const std::string& table) {
  if (IsOnSqlite()) return ColumnIn(store, "SELECT name FROM pragma_table_info('" + table + "')").front();
  return TextIn(store,
                "SELECT CAST(column_name AS TEXT) FROM information_schema.columns WHERE table_schema = 'rigcal' AND "
                "table_name = '" +
                    table + "' ORDER BY ordinal_position LIMIT 1");
}

// Whether the database refuses the statement.
bool IsRefused(Store& store, const std::string& sql) {
  return !store.connection().Append("a table", [&]() -> Status {
    Query(store, sql).Run();
    return {};
  });
}

class AppendOnlyTest : public StoreTest {
 protected:
  // A session that holds what another does, and says that a sensor was moved.
  void AppendRepeat() {
    Manifest manifest = MakeManifest(3);
    manifest.header.remounted = {SensorId("left")};
    manifest.header.sensors[0].serial = "SN 1";
    const SessionId id = IdOf(manifest);
    ASSERT_TRUE(AppendSession(store_, id, formats::WriteManifest(manifest), manifest, {10}));
    ASSERT_TRUE(AppendHeld(store_, id, {0, 1, 2}, {11}));
    ASSERT_TRUE(CloseSession(store_, id, {}, {12}));
  }
  // A session and its robot that were computed again.
  void AppendRecomputed(const SessionId& session) {
    ASSERT_TRUE(
        AppendRecomputation(store_, {0, "all", "", "Ada", {9}, "0.2.0", "joint/7"}, {{kRobot, {{session, ""}}}}));
    const auto item = LoadNextRecomputation(store_, {}).value().value();
    ASSERT_TRUE(FinishRecomputedSession(store_, item, SessionAnew::kKept, "lost", {9}));
    const PoseChange change{SensorId("right"), "moved", 0.001, 0.002, 1.5};
    ASSERT_TRUE(FinishRecomputedRobot(store_, item, {kRobot, RobotAnew::kChanged, 1, 0, "", {change}}, 1, {9}));
  }
  void AppendAccess() {
    const Word word{{9}, "root", ""};
    ASSERT_TRUE(AddAccount(store_, {0, "ada", Role::kAdmin, "hash", word}));
    ASSERT_TRUE(AddAccessToken(store_, {0, "grafana", Role::kViewer, DigestOf("token"), word}));
    ASSERT_TRUE(RevokeAccessToken(store_, "grafana", word));
  }
  static BoardMeasure MeasuredBoard() {
    BoardMeasure measure;
    measure.serial = "B-7", measure.pattern = {TargetKind::kCheckerboard, 9, 6, 0.025};
    measure.length_x_m = measure.length_y_m = measure.measured_x_m = measure.measured_y_m = 0.2,
    measure.sigma_m = 0.0002;
    measure.word = {{6}, "Ada", ""};
    return measure;
  }
  // At least one row in each table.
  void SetUp() override {
    const SensorPair pair{SensorId("left"), SensorId("right")};
    const SessionId session = AppendClosedSession(store_, 2, {pair});
    AppendRepeat();
    const JobRow job = LoadNextJob(store_, {}).value().value();
    Edge edge = MakeEdge(1);
    edge.session = session;
    const BatchId batch(DigestOf("batch").str());
    ASSERT_TRUE(store_.Write([&]() -> Status {
      RIGCAL_TRY(AppendEdge(store_, edge, {1}));
      RIGCAL_TRY(BeginAttempt(store_, WorkOfJob(job.number), {1}));
      RIGCAL_TRY(EndAttempt(store_, WorkOfJob(job.number), AttemptEnd::kDone, "", {2}));
      RIGCAL_TRY(FinishJob(store_, job.number, {2}));
      RIGCAL_TRY(AppendBatch(store_, kRobot, batch, 2, {3}));
      RIGCAL_TRY(AppendBatchItem(store_, batch, 0, edge, {3}));
      RIGCAL_TRY(AppendView(store_, DigestOf("image"), "chessboard 1", {}));
      RIGCAL_TRY(AppendCloud(store_, DigestOf("cloud"), "plate 1", {{true, "", {}, 7, {PlanePatch{}}}, {}}));
      RIGCAL_TRY(RetireEdge(store_, edge.id, {{4}, "Ada", "typed wrong"}));
      RIGCAL_TRY(AppendAudit(store_, {5}, "Ada", "pushed"));
      Revision revision = MakeRevision(1);
      revision.calibrated_at = Stamp{4};
      RIGCAL_ASSIGN(const int number, AppendRevision(store_, revision));
      JointPoses poses{
          SensorId("left"), {{SensorId("left"), {}}}, {{{SensorId("right")}, Eigen::MatrixXd::Identity(6, 6)}}};
      RIGCAL_TRY(AppendRevisionPoses(store_, {kRobot, number}, poses));
      RIGCAL_TRY(AppendWorstEdge(store_, {kRobot, number}, {SensorId("left"), SensorId("right"), 1.5}));
      RIGCAL_TRY(AppendCauseKeys(store_, {kRobot, number}, {"board_unseen rear"}));
      AsFound found;
      found.session = session;
      RIGCAL_TRY(AppendAsFound(store_, {kRobot, number}, found));
      MergedEdge merged;
      merged.frame_a = SensorId("left"), merged.frame_b = SensorId("right"), merged.count = 1;
      merged.constants["board"] = {Vector6d::Ones()};
      RIGCAL_TRY(
          AppendMergedEdges(store_, {kRobot, number}, {{merged}, {edge.id}, {}}, *LoadWhatCounts(store_, kRobot)));
      SessionEstimate estimate;
      estimate.session = session, estimate.reference = SensorId("left");
      RIGCAL_TRY(AppendSessionEstimate(store_, estimate, "joint/1", {6}));
      RIGCAL_TRY(AppendLost(store_, DigestOf("image"), BlobState::kDamaged, job.number, {6}));
      RIGCAL_TRY(AppendBoardMeasure(store_, MeasuredBoard()));
      RIGCAL_TRY(AppendPolicy(store_, {}, "tolerance_mm: 4", {{6}, "Ada", "new mounts"}));
      RIGCAL_TRY(AppendRigModel(store_, "mars", "rig_model: mars", {{6}, "Ada", "drawing 7"}));
      RIGCAL_TRY(BeginEpoch(store_, kRobot, {SensorId("left")}, {6}, {{6}, "Ada", "new bracket"}));
      RIGCAL_TRY(AppendDecision(store_, kRobot, number, Deciding::kApprove, {{6}, "Ada", "checked"}));
      RIGCAL_TRY(AppendRuns(store_, {kRobot, revision.digest, {7}, "rigcal agent"}, {8}));
      RIGCAL_TRY(AppendRevisionStatus(store_, {kRobot, number}, {}));
      RIGCAL_TRY(AppendModelVisit(store_, "mars", {kRobot, number}, session));
      RIGCAL_TRY(SetReceivers(store_, {"http://localhost/a"}, {8}));
      RIGCAL_TRY(AppendAlert(store_, formats::StatusAlert(kRobot, number, StatusWord::kOk, {}, {8})));
      RIGCAL_TRY(MarkDelivered(store_, "http://localhost/a", 1, 204, {9}));
      RobotSummary summary;
      summary.robot = kRobot;
      RIGCAL_TRY(ReplaceSummary(store_, summary, 1'000'000));
      RIGCAL_TRY(NoteStatus(store_, kRobot, {9}));
      return AppendPublication(store_, {kRobot, number}, {6});
    }));
    AppendRecomputed(session), AppendAccess();
  }
};

TEST_F(AppendOnlyTest, EveryTableButTheQueues) {
  const std::vector<std::string> tables =
      ColumnIn(store_, "SELECT name FROM (" + kTables +
                           ") t WHERE name NOT LIKE 'waiting%' AND name NOT LIKE 'merge_state%' AND name NOT LIKE "
                           "'summary%' AND name NOT LIKE 'login%' AND name NOT LIKE 'lease%'");
  EXPECT_GE(tables.size(), 20u);
  for (const std::string& table : tables) {
    EXPECT_NE(IntIn(store_, "SELECT count(*) FROM " + table), 0) << table << " is not put to the test";
    const std::string first = FirstColumnOf(store_, table);
    EXPECT_TRUE(IsRefused(store_, "DELETE FROM " + table)) << table;
    EXPECT_TRUE(IsRefused(store_, "UPDATE " + table + " SET " + first + " = " + first)) << table;
    const std::string again =
        IsOnSqlite() ? "INSERT OR REPLACE INTO " + table + " SELECT * FROM " + table : "TRUNCATE " + table + " CASCADE";
    EXPECT_TRUE(IsRefused(store_, again)) << table;
  }
}

TEST_F(AppendOnlyTest, AClosedSessionTakesNoMorePayloads) {
  const std::string digest(64, 'a');
  EXPECT_TRUE(IsRefused(store_, "INSERT INTO payload VALUES (1, 2, 'left/x.png', '" + digest + "', 5)"));
}

TEST_F(AppendOnlyTest, UnitsAreTheEndOfColumnNames) {
  const std::vector<std::string> reals = ColumnIn(store_, kRealColumns);
  ASSERT_FALSE(reals.empty());
  for (const std::string& name : reals) {
    const bool unitless = name.find("_q") != std::string::npos || name == "edge_figure.value" ||
                          name == "edge_capture.rms" || name.ends_with("_dof");
    const std::vector<std::string> units = {"_m", "_rad", "_m2", "_rad2", "_ratio"};
    EXPECT_TRUE(unitless ||
                std::any_of(units.begin(), units.end(), [&](const auto& unit) { return name.ends_with(unit); }))
        << name;
  }
}

}  // namespace
}  // namespace rigcal::storage
