#include "server/pipeline/robots/robot_summary.h"

#include "server/pipeline/robots/decide.h"
#include "server/pipeline/robots/unknown_names.h"
#include "server/pipeline/robots/validity.h"
#include "storage/alerts/revision_status.h"
#include "storage/edges/edges.h"
#include "storage/fleet/calibration_series.h"
#include "storage/fleet/fleet_facts.h"
#include "storage/revisions/decisions.h"
#include "storage/revisions/revisions.h"
#include "storage/settings/policies.h"
#include "storage/work/jobs.h"

namespace rigcal::pipeline {
namespace {

// Of a robot without a revision.
Verdict FirstVerdict(const RobotSummary& summary, const std::optional<Error>& incomplete) {
  const char* wait = "Wait: the result appears by itself.";
  if (!summary.validity.given_up.empty()) return {VerdictLevel::kUnknown, summary.validity.given_up, ""};
  if (summary.jobs_waiting > 0) return {VerdictLevel::kUnknown, "The first session is being calibrated.", wait};
  if (summary.edges > 0) return {VerdictLevel::kUnknown, "The first result is being worked out.", wait};
  if (summary.last_session_at)
    return {VerdictLevel::kUnknown, "No session of it has two sensors that can be calibrated against each other.",
            "Name at least two sensors in session.yaml that see one target, or that move together, and push it again."};
  if (summary.sessions > 0)
    return {VerdictLevel::kUnknown, "The first session is arriving, or its push broke off.",
            "Wait a moment; if nothing changes, push it again: what is here already is not sent twice."};
  if (incomplete)
    return {VerdictLevel::kUnknown, "There is no revision yet: " + incomplete->what + ".", incomplete->cure};
  return {VerdictLevel::kUnknown, "There is no revision yet.", "Push a capture session or finished edges."};
}

Status TakeArrivals(storage::Store& store, RobotSummary& summary) {
  RIGCAL_TRY(LoadWhatIsNew(store, summary.robot, summary.validity));
  RIGCAL_ASSIGN(const auto incomplete, IncompleteBatch(store, summary.robot));
  summary.verdict = FirstVerdict(summary, incomplete);
  return {};
}

// Nothing of one that waited for pairs, or from before it was kept.
Status TakeStatus(storage::Store& store, const Revision& revision, RobotSummary& summary) {
  RIGCAL_ASSIGN(auto facts, storage::LoadRevisionStatus(store, {revision.robot, revision.number}));
  if (!facts) return {};
  summary.found = FoundOf(*facts);
  summary.drift_due = DriftDueOf(*facts);
  summary.site = std::move(facts->site);
  summary.sensors = std::move(facts->sensors);
  summary.basis = std::move(facts->basis);
  return {};
}

Status TakeNewestVisit(storage::Store& store, RobotSummary& summary) {
  RIGCAL_ASSIGN(auto newest, storage::LoadNewestCapture(store, summary.robot));
  if (newest) summary.last_session_at = newest->at;
  if (newest) summary.operator_name = std::move(newest->operator_name);
  RIGCAL_ASSIGN(summary.rig_model, storage::LoadRigModel(store, summary.robot));
  return {};
}

Status TakeCalibrations(storage::Store& store, RobotSummary& summary) {
  RIGCAL_ASSIGN(summary.calibrations, storage::LoadCalibrations(store, summary.robot));
  return {};
}

Status TakeRevision(storage::Store& store, const Revision& revision, Stamp now, RobotSummary& summary) {
  summary.revision = revision.number;
  summary.verdict = revision.verdict;
  RIGCAL_ASSIGN(summary.validity, LoadValidity(store, revision, now));
  RIGCAL_ASSIGN(summary.state, storage::LoadRevisionState(store, revision, summary.validity.usable));
  RIGCAL_ASSIGN(summary.worst, storage::LoadWorstEdge(store, {revision.robot, revision.number}));
  RIGCAL_ASSIGN(summary.causes, storage::LoadCauseKeys(store, {revision.robot, revision.number}));
  RIGCAL_TRY(TakeStatus(store, revision, summary));
  if (summary.validity.calibrated_at) RIGCAL_TRY(TakeCalibrations(store, summary));
  if (!summary.validity.calculating) return {};
  // What arrived since is told once it is in a revision: one page shows the numbers of one revision.
  RIGCAL_ASSIGN(summary.edges, storage::CountEdges(store, revision.robot, revision.edge_watermark));
  return {};
}

}  // namespace

Result<storage::RobotRow> LoadKnownRobot(storage::Store& store, const RobotId& robot) {
  RIGCAL_ASSIGN(const auto known, storage::LoadRobot(store, robot));
  if (known) return *known;
  return Fail(UnknownRobot(store, robot));
}

Result<RobotSummary> LoadRobotSummary(storage::Store& store, const RobotId& robot, Stamp now) {
  RIGCAL_ASSIGN(const storage::RobotRow row, LoadKnownRobot(store, robot));
  RobotSummary summary;
  summary.robot = robot;
  summary.sessions = row.sessions;
  summary.edges = row.edges;
  RIGCAL_ASSIGN(summary.jobs_waiting, storage::CountJobs(store, robot));
  RIGCAL_TRY(TakeNewestVisit(store, summary));
  RIGCAL_ASSIGN(summary.runs, LoadWhatRuns(store, robot));
  if (summary.runs) summary.runs->digest = {};  // it is told of one robot that is asked for alone
  RIGCAL_ASSIGN(const auto revision, storage::LoadRevisionSummary(store, robot, 0));
  RIGCAL_TRY(revision ? TakeRevision(store, *revision, now, summary) : TakeArrivals(store, summary));
  return summary;
}

Result<std::optional<Error>> IncompleteBatch(storage::Store& store, const RobotId& robot) {
  RIGCAL_ASSIGN(const auto batches, storage::LoadOpenBatches(store, robot));
  if (batches.empty()) return std::nullopt;
  const storage::OpenBatch& batch = batches.front();
  return Error{ErrorCode::kNotFound,
               "a batch of " + std::to_string(batch.items) + " edges is incomplete: " + std::to_string(batch.held) +
                   " of " + std::to_string(batch.items) + " since " + ToIso(batch.newest_at),
               "Push the same edges again: that completes it, and nothing is stored twice."};
}

}  // namespace rigcal::pipeline
