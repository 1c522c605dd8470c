#include "server/pipeline/robots/validity.h"

#include <algorithm>
#include <set>

#include "server/pipeline/attempt.h"
#include "server/pipeline/sessions/session_refinement.h"
#include "storage/edges/edges.h"
#include "storage/revisions/decisions.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/epochs.h"
#include "storage/sessions/retired.h"
#include "storage/sessions/session_estimates.h"
#include "storage/sessions/sessions.h"
#include "storage/sessions/standing.h"
#include "storage/work/attempts.h"
#include "storage/work/jobs.h"

namespace rigcal::pipeline {
namespace {

// Whether an epoch of a sensor, which is not gone since, began by what was said after `solved_at`: by a session that
// came later, or by a person.
Result<bool> BeganEpochAfter(storage::Store& store, const RobotId& robot, Stamp solved_at) {
  RIGCAL_ASSIGN(const auto epochs, storage::LoadEpochs(store, robot));
  RIGCAL_ASSIGN(const auto gone, storage::LoadRetiredSensors(store, robot));
  std::set<SessionId> named;
  for (const Epoch& epoch : epochs) {
    if (gone.contains(epoch.sensor)) continue;
    if (epoch.cause != EpochCause::kPerson) named.insert(epoch.session);
    if (epoch.cause == EpochCause::kPerson && epoch.word.at > solved_at) return true;
  }
  for (const SessionId& id : named) {
    RIGCAL_ASSIGN(const auto session, storage::LoadSession(store, id));
    if (session && session->closed_at > solved_at) return true;
  }
  return false;
}

// Whether a sensor gave way during a session that came after `solved_at`: what was known of it before holds no more.
// That of one that is gone since says nothing of the others, nor does a session that was retired.
Result<bool> GaveWayAfter(storage::Store& store, const RobotId& robot, Stamp solved_at) {
  constexpr int kSessionsAsked = 8;  // what came after it is among the newest
  RIGCAL_ASSIGN(const auto rows, storage::LoadSessionEstimates(store, robot, kSessionEstimator, kSessionsAsked));
  RIGCAL_ASSIGN(const auto gone, storage::LoadRetiredSensors(store, robot));
  const auto is_gone = [&](const SensorMovedWithin& moved) { return gone.contains(moved.sensor); };
  for (const storage::SessionEstimateRow& row : rows) {
    if (!row.estimate) continue;
    const auto& moved = row.estimate->moved;
    if (std::all_of(moved.begin(), moved.end(), is_gone)) continue;
    RIGCAL_ASSIGN(const auto session, storage::LoadSession(store, row.session));
    if (session && session->closed_at > solved_at) return true;
  }
  return false;
}

// Whether its poses are those of the rig as the newest revision knows it.
Result<bool> IsOfThisRig(storage::Store& store, const Revision& revision) {
  RIGCAL_ASSIGN(const auto newest, storage::LoadRevisionSummary(store, revision.robot, 0));
  if (newest && newest->number == revision.number) return true;
  RIGCAL_ASSIGN(const bool began_epoch, BeganEpochAfter(store, revision.robot, revision.created_at));
  if (began_epoch) return false;
  RIGCAL_ASSIGN(const bool gave_way, GaveWayAfter(store, revision.robot, revision.created_at));
  return !gave_way;
}

Result<std::string> LoadGivenUp(storage::Store& store, const RobotId& robot) {
  RIGCAL_ASSIGN(const std::int64_t edges, storage::LoadEdgeWatermark(store, robot));
  RIGCAL_ASSIGN(const std::int64_t standing, storage::LoadStandingWatermark(store, robot));
  RIGCAL_ASSIGN(const auto attempts, storage::LoadAttempts(store, storage::WorkOfRevision(robot, edges, standing)));
  if (attempts.under_way || attempts.failed + attempts.cut_off < kAttemptsMax) return std::string();
  return "What came last is in no revision: " + WhyGivenUp(attempts, "solved the graph of robot " + robot.str()) +
         ". Give the server more memory and push another session, or take the newest edge out with `rigcal retire`.";
}

// It is the newest, or in use while the newest, which could be, was not approved.
bool IsKept(const Revision& revision, const Revision& newest, const std::optional<UsableRevision>& in_use) {
  if (revision.number >= newest.number) return true;
  return in_use && in_use->number == revision.number && IsUsable(newest.verdict);
}

}  // namespace

Result<std::optional<UsableRevision>> LoadUsable(storage::Store& store, const RobotId& robot) {
  RIGCAL_ASSIGN(const auto usable, storage::LoadUsableRevision(store, robot));
  if (!usable) return std::nullopt;
  RIGCAL_ASSIGN(const bool is_of_this_rig, IsOfThisRig(store, *usable));
  if (!is_of_this_rig) return std::nullopt;
  return UsableRevision{usable->number, usable->created_at, usable->calibrated_at, usable->max_age_ns};
}

Result<std::optional<Revision>> LoadFallback(storage::Store& store, const RobotId& robot) {
  RIGCAL_ASSIGN(auto fallback, storage::LoadStillUsable(store, robot));
  if (!fallback) return std::nullopt;
  RIGCAL_ASSIGN(const bool is_of_this_rig, IsOfThisRig(store, *fallback));
  if (!is_of_this_rig) fallback.reset();
  return fallback;
}

Status LoadWhatIsNew(storage::Store& store, const RobotId& robot, Validity& validity) {
  RIGCAL_ASSIGN(const std::int64_t jobs, storage::CountJobs(store, robot));
  RIGCAL_ASSIGN(const bool unsolved, storage::IsUnsolved(store, robot));
  if (jobs == 0 && unsolved) {
    RIGCAL_ASSIGN(validity.given_up, LoadGivenUp(store, robot));
  }
  validity.calculating = jobs > 0 || (unsolved && validity.given_up.empty());
  return {};
}

Result<Validity> LoadValidity(storage::Store& store, const Revision& revision, Stamp now) {
  Validity validity;
  validity.calibrated_at = revision.calibrated_at;
  validity.max_age_ns = revision.max_age_ns;
  validity.overdue = IsOverdue(validity.calibrated_at, validity.max_age_ns, now);
  RIGCAL_ASSIGN(validity.usable, LoadUsable(store, revision.robot));
  RIGCAL_TRY(LoadWhatIsNew(store, revision.robot, validity));
  RIGCAL_ASSIGN(const auto newest, storage::LoadRevisionSummary(store, revision.robot, 0));
  if (newest && !IsKept(revision, *newest, validity.usable)) validity.superseded_by = newest->number;
  validity.approved = IsApproved(revision.verdict, revision.number, validity.usable);
  return validity;
}

}  // namespace rigcal::pipeline
