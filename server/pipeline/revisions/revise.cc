#include "server/pipeline/revisions/revise.h"

#include <utility>

#include "server/base/log.h"
#include "server/base/version.h"
#include "server/graph/uncertainty/pose_changes.h"
#include "server/pipeline/revisions/solve_robot.h"
#include "server/pipeline/rig_models/population.h"
#include "server/pipeline/robots/decide.h"
#include "server/pipeline/robots/validity.h"
#include "storage/alerts/outbox.h"
#include "storage/alerts/revision_status.h"
#include "storage/fleet/fleet_facts.h"
#include "storage/revisions/as_found.h"
#include "storage/revisions/revision_made.h"
#include "storage/revisions/revision_poses.h"
#include "storage/revisions/revisions.h"
#include "storage/work/attempts.h"
#include "storage/work/recomputations.h"

namespace rigcal::pipeline {
namespace {

Status AppendBeside(storage::Store& store, const storage::RevisionKey& key, const std::string& rig_model,
                    const JudgedBeside& beside) {
  RIGCAL_TRY(storage::AppendCauseKeys(store, key, beside.cause_keys));
  if (beside.status) RIGCAL_TRY(storage::AppendRevisionStatus(store, key, *beside.status));
  if (!beside.as_found) return {};
  RIGCAL_TRY(storage::AppendAsFound(store, key, *beside.as_found));
  return storage::AppendModelVisit(store, rig_model, key, beside.as_found->session);
}

// In the transaction of the revision. While pairs wait it is not known yet.
Status TellFailedSession(storage::Store& store, const SolvedRobot& solved) {
  const Revision& revision = solved.revision;
  RIGCAL_ASSIGN(const auto failed,
                FindFailedSession(store, solved.input, solved.captured_at, revision.number, revision.created_at));
  return failed ? storage::AppendAlert(store, *failed) : Status{};
}

// Inside the Write that appended the revision, which has its number.
Status AppendRest(storage::Store& store, const SolvedRobot& solved) {
  const storage::RevisionKey key{solved.revision.robot, solved.revision.number};
  RIGCAL_TRY(storage::AppendRevisionPoses(store, key, solved.poses));
  if (solved.placed) RIGCAL_TRY(storage::AppendPlacedPoses(store, key, *solved.placed));
  RIGCAL_TRY(storage::AppendMergedEdges(store, key, solved.merge, solved.counts));
  RIGCAL_TRY(AppendBeside(store, key, solved.rig_model, solved.beside));
  return solved.worst ? storage::AppendWorstEdge(store, key, *solved.worst) : Status();
}

// After what the policy decided: what its report tells, whenever that is drawn.
Status KeepHowMade(storage::Store& store, const Revision& revision) {
  RIGCAL_ASSIGN(const auto usable, LoadUsable(store, revision.robot));
  storage::RevisionMade made{std::string(Version()), std::nullopt};
  if (usable) made.in_use = usable->number;
  return storage::AppendRevisionMade(store, {revision.robot, revision.number}, made);
}

// What a merge from all edges made of them, and how many robots still wait for one.
void LogMergedAnew(storage::Store& store, const RobotId& robot, const storage::MergeStep& step) {
  const auto waiting = storage::CountToMergeAnew(store);
  if (!waiting) return LogError(waiting.error());
  int within = 0;
  for (const MergedEdge& one : step.merged) within += one.count;
  LogInfo("robot " + robot.str() + ": " + std::to_string(within) + " of its " + std::to_string(step.back.size()) +
          " edges merged anew; robots still to be merged anew: " + std::to_string(*waiting));
}

// What the candidate is compared with; 0: nothing.
Result<int> LoadAgainst(storage::Store& store, const RobotId& robot, const std::optional<Revision>& newest) {
  RIGCAL_ASSIGN(const auto usable, LoadUsable(store, robot));
  if (usable) return usable->number;
  return newest ? newest->number : 0;
}

Result<std::vector<PoseChange>> LoadChanges(storage::Store& store, const RobotId& robot, int against,
                                            const JointPoses& after) {
  if (against == 0) return std::vector<PoseChange>();
  RIGCAL_ASSIGN(const auto before, storage::LoadRevisionPoses(store, {robot, against}));
  return before ? graph::PoseChangesBetween(*before, after) : std::vector<PoseChange>();
}

}  // namespace

Result<Revision> Revise(storage::Store& store, const RobotId& robot, const Clock& clock, std::int64_t pairs_waiting,
                        bool merges_anew) {
  RIGCAL_ASSIGN(SolvedRobot solved, SolveRobot(store, robot, clock, {pairs_waiting, 0, merges_anew}));
  Revision& revision = solved.revision;
  solved.merge.never_anew = !merges_anew;
  RIGCAL_TRY(store.Write([&]() -> Status {
    RIGCAL_ASSIGN(revision.number, storage::AppendRevision(store, revision));
    const bool found_drift = solved.beside.as_found && StateOf(*solved.beside.as_found) == FoundState::kDrifted;
    RIGCAL_TRY(AppendRest(store, solved));
    RIGCAL_TRY(ApproveByPolicy(store, revision, found_drift, clock.Now()));  // a decision holds the poses, too
    RIGCAL_TRY(KeepHowMade(store, revision));
    if (pairs_waiting > 0) return {};
    RIGCAL_TRY(KeepVisitScatter(store, robot, solved.rig_model, solved.input.reference, solved.input.solution));
    return TellFailedSession(store, solved);
  }));
  if (solved.merge.anew) LogMergedAnew(store, robot, solved.merge);
  return std::move(revision);
}

Result<RecomputedRobot> ReviseAnew(storage::Store& store, const storage::RecomputationItem& item, const Clock& clock) {
  RIGCAL_ASSIGN(SolvedRobot solved, SolveRobot(store, item.robot, clock, {0, item.run}));
  Revision& revision = solved.revision;
  RIGCAL_ASSIGN(const auto newest, storage::LoadRevisionSummary(store, item.robot, 0));
  RecomputedRobot done{item.robot, RobotAnew::kUnchanged, 0, 0, "", {}};
  RIGCAL_ASSIGN(done.against, LoadAgainst(store, item.robot, newest));
  const bool is_same = newest && newest->digest == revision.digest;
  if (!is_same) {
    done.how = RobotAnew::kChanged;
    RIGCAL_ASSIGN(done.changes, LoadChanges(store, item.robot, done.against, solved.poses));
  }
  RIGCAL_TRY(store.Write([&]() -> Status {
    if (!is_same) {
      RIGCAL_ASSIGN(revision.number, storage::AppendRevision(store, revision));
      RIGCAL_TRY(AppendRest(store, solved));
      RIGCAL_TRY(KeepHowMade(store, revision));
      done.revision = revision.number;
    }
    RIGCAL_TRY(
        storage::EndAttempt(store, storage::WorkOfRecomputation(item), storage::AttemptEnd::kDone, "", clock.Now()));
    return storage::FinishRecomputedRobot(store, item, done, revision.edge_watermark, clock.Now());
  }));
  return done;
}

}  // namespace rigcal::pipeline
