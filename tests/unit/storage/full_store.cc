#include "tests/unit/storage/full_store.h"

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
#include "storage/revisions/revision_made.h"
#include "storage/revisions/revision_poses.h"
#include "storage/sessions/epochs.h"
#include "storage/sessions/retired.h"
#include "storage/sessions/session_estimates.h"
#include "storage/settings/policies.h"
#include "storage/settings/rig_models.h"
#include "storage/sites/forward_queue.h"
#include "storage/work/attempts.h"
#include "storage/work/recomputations.h"
#include "tests/unit/storage/fixture.h"

namespace rigcal::storage {
namespace {

// A session that holds what another does, and says that a sensor was moved.
void AppendRepeat(Store& store) {
  Manifest manifest = MakeManifest(3);
  manifest.header.remounted = {SensorId("left")};
  manifest.header.sensors[0].serial = "SN 1";
  const SessionId id = IdOf(manifest);
  ASSERT_TRUE(AppendSession(store, id, formats::WriteManifest(manifest), manifest, {10}));
  ASSERT_TRUE(AppendHeld(store, id, {0, 1, 2}, {11}));
  ASSERT_TRUE(CloseSession(store, id, {}, {12}));
}

// A session and its robot that were computed again.
void AppendRecomputed(Store& store, const SessionId& session) {
  ASSERT_TRUE(AppendRecomputation(store, {0, "all", "", "Ada", {9}, "0.2.0", "joint/7"}, {{kRobot, {{session, ""}}}}));
  const auto item = LoadNextRecomputation(store, {}).value().value();
  ASSERT_TRUE(FinishRecomputedSession(store, item, SessionAnew::kKept, "lost", {9}));
  const PoseChange change{SensorId("right"), "moved", 0.001, 0.002, 1.5};
  ASSERT_TRUE(FinishRecomputedRobot(store, item, {kRobot, RobotAnew::kChanged, 1, 0, "", {change}}, 1, {9}));
}

void AppendAccess(Store& store) {
  const Word word{{9}, "root", ""};
  ASSERT_TRUE(AddAccount(store, {0, "ada", Role::kAdmin, "hash", word}));
  ASSERT_TRUE(AddAccessToken(store, {0, "grafana", Role::kViewer, DigestOf("token"), word}));
  ASSERT_TRUE(RevokeAccessToken(store, "grafana", word));
  ASSERT_TRUE(AddAccessToken(store, {0, "harbour", Role::kViewer, DigestOf("token of a site"), word, "*"}));
  ASSERT_TRUE(SetCentre(store, "https://centre", {9}));
  const auto whole = LoadNextForward(store, {9});
  ASSERT_TRUE(whole && *whole);
  ASSERT_TRUE(MarkForwarded(store, **whole, {9}));
}

BoardMeasure MeasuredBoard() {
  BoardMeasure measure;
  measure.serial = "B-7", measure.pattern = {TargetKind::kCheckerboard, 9, 6, 0.025};
  measure.length_x_m = measure.length_y_m = measure.measured_x_m = measure.measured_y_m = 0.2, measure.sigma_m = 0.0002;
  measure.word = {{6}, "Ada", ""};
  return measure;
}

// Of one pair, which contradict each other.
// Of weak edges of sessions, and a part of pushed ones.
std::vector<MergedEdge> TwoMerged() {
  std::vector<MergedEdge> parts(2);
  for (MergedEdge& merged : parts) {
    merged.frame_a = SensorId("left"), merged.frame_b = SensorId("right"), merged.count = 1;
    merged.constants["board"] = {Vector6d::Ones()};
  }
  parts.front().of_sessions = parts.front().weak = true;
  parts.back().part = 1;
  return parts;
}

PlacedPoses PlacedRight() {
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(6, 6);
  return {SensorId("left"), {SensorId("right")}, {Se3()}, one, one.leftCols(1)};
}
}  // namespace

void FillEveryTable(Store& store) {
  const SensorPair pair{SensorId("left"), SensorId("right")};
  const SessionId session = AppendClosedSession(store, 2, {pair});
  AppendRepeat(store);
  const JobRow job = LoadNextJob(store, {}).value().value();
  Edge edge = MakeEdge(1);
  edge.session = session;
  const BatchId batch(DigestOf("batch").str());
  ASSERT_TRUE(store.Write([&]() -> Status {
    RIGCAL_TRY(AppendEdge(store, edge, {1}));
    Query(store, "INSERT INTO edge_block VALUES (?, 0, 'c0', 0, 0, 0, 0, 0, 0)").Bind(1).Run();  // as of before
    RIGCAL_TRY(BeginAttempt(store, WorkOfJob(job.number), {1}));
    RIGCAL_TRY(EndAttempt(store, WorkOfJob(job.number), AttemptEnd::kDone, "", {2}));
    RIGCAL_TRY(FinishJob(store, job.number, {2}));
    RIGCAL_TRY(AppendBatch(store, kRobot, batch, 2, {3}));
    RIGCAL_TRY(AppendBatchItems(store, batch, {{0, edge}}, {3}));
    RIGCAL_TRY(AppendView(store, DigestOf("image"), "chessboard 1", {}));
    RIGCAL_TRY(AppendCloud(store, DigestOf("cloud"), "plate 1", {{true, "", {}, 7, {PlanePatch{}}}, {}}));
    RIGCAL_TRY(RetireEdge(store, edge.id, {{4}, "Ada", "typed wrong"}));
    RIGCAL_TRY(AppendAudit(store, {5}, "Ada", "pushed"));
    Revision revision = MakeRevision(1);
    revision.calibrated_at = Stamp{4};
    RIGCAL_ASSIGN(const int number, AppendRevision(store, revision));
    JointPoses poses{
        SensorId("left"), {{SensorId("left"), {}}}, {{{SensorId("right")}, Eigen::MatrixXd::Identity(6, 6)}}};
    RIGCAL_TRY(AppendRevisionPoses(store, {kRobot, number}, poses));
    RIGCAL_TRY(AppendPlacedPoses(store, {kRobot, number}, PlacedRight()));
    RIGCAL_TRY(AppendRevisionMade(store, {kRobot, number}, {"1.2.3", number}));
    RIGCAL_TRY(AppendWorstEdge(store, {kRobot, number}, {SensorId("left"), SensorId("right"), 1.5}));
    RIGCAL_TRY(AppendCauseKeys(store, {kRobot, number}, {"board_unseen rear"}));
    AsFound found;
    found.session = session;
    RIGCAL_TRY(AppendAsFound(store, {kRobot, number}, found));
    RIGCAL_TRY(
        AppendMergedEdges(store, {kRobot, number}, {TwoMerged(), {edge.id}, {}}, *LoadWhatCounts(store, kRobot)));
    SessionEstimate estimate;
    estimate.session = session, estimate.reference = SensorId("left");
    RIGCAL_TRY(AppendSessionEstimate(store, estimate, "joint/1", {6}));
    RIGCAL_TRY(AppendLost(store, DigestOf("image"), BlobState::kDamaged, job.number, {6}));
    RIGCAL_TRY(AppendBoardMeasure(store, MeasuredBoard()));
    RIGCAL_TRY(AppendPolicy(store, {}, "tolerance_mm: 4", {{6}, "Ada", "new mounts"}));
    RIGCAL_TRY(AppendRigModel(store, "mars", "rig_model: mars", {{6}, "Ada", "drawing 7"}));
    RIGCAL_TRY(BeginEpoch(store, kRobot, {SensorId("left")}, {6}, {{6}, "Ada", "new bracket"}));
    RIGCAL_TRY(AppendDecision(store, kRobot, number, Deciding::kApprove, {{6}, "Ada", "checked"}));
    RIGCAL_TRY(AppendRuns(store, {kRobot, revision.digest, {7}, "rigcal agent"}, {8}));
    RIGCAL_TRY(AppendRevisionStatus(store, {kRobot, number}, {}));
    RIGCAL_TRY(AppendModelVisit(store, "mars", {kRobot, number}, session));
    RIGCAL_TRY(SetReceivers(store, {"http://localhost/a"}, {8}));
    RIGCAL_TRY(AppendAlert(store, formats::StatusAlert(kRobot, number, StatusWord::kOk, {}, {8})));
    RIGCAL_TRY(MarkDelivered(store, "http://localhost/a", 1, 204, {9}));
    RobotSummary summary;
    summary.robot = kRobot;
    RIGCAL_TRY(ReplaceSummary(store, summary, 1'000'000));
    RIGCAL_TRY(NoteStatus(store, kRobot, {9}));
    return AppendPublication(store, {kRobot, number}, {6});
  }));
  AppendRecomputed(store, session);
  AppendAccess(store);
}

}  // namespace rigcal::storage
