#include "server/pipeline/robots/validity.h"

#include <algorithm>

#include "server/pipeline/attempt.h"
#include "server/pipeline/sessions/session_refinement.h"
#include "storage/edges/edges.h"
#include "storage/revisions/decisions.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/epochs.h"
#include "storage/sessions/retired.h"
#include "storage/sessions/session_estimates.h"
#include "storage/sessions/standing.h"
#include "storage/work/attempts.h"
#include "storage/work/jobs.h"

namespace rigcal::pipeline {
namespace {

// Whether an epoch of a sensor, which is not gone since, began by what was said after `standing`: by a session that
// counts only since, or by a person. By the order of words, as clocks are set back.
Result<bool> BeganEpochSince(storage::Store& store, const RobotId& robot, std::int64_t standing) {
  RIGCAL_ASSIGN(const auto epochs, storage::LoadEpochs(store, robot));
  RIGCAL_ASSIGN(const auto gone, storage::LoadRetiredSensors(store, robot));
  RIGCAL_ASSIGN(const auto newer, storage::LoadMadeCurrentSince(store, robot, standing));
  return std::any_of(epochs.begin(), epochs.end(), [&](const Epoch& epoch) {
    if (gone.contains(epoch.sensor)) return false;
    return epoch.cause == EpochCause::kPerson ? epoch.standing > standing : newer.contains(epoch.session);
  });
}

// Whether a sensor gave way during a session that counts only since `standing`: what was known of it before holds no
// more, however many sessions came after it. That of one that is gone since says nothing of the others, nor does a
// session that was retired.
Result<bool> GaveWaySince(storage::Store& store, const RobotId& robot, std::int64_t standing) {
  RIGCAL_ASSIGN(const auto newer, storage::LoadSessionEstimatesSince(store, robot, kSessionEstimator, standing));
  RIGCAL_ASSIGN(const auto gone, storage::LoadRetiredSensors(store, robot));
  const std::vector<SessionEstimate> all = IslandsApart(newer);
  return std::any_of(all.begin(), all.end(), [&](const SessionEstimate& session) {
    return std::any_of(session.moved.begin(), session.moved.end(),
                       [&](const SensorMovedWithin& moved) { return !gone.contains(moved.sensor); });
  });
}

// Whether its poses are those of the rig as the newest revision knows it.
Result<bool> IsOfThisRig(storage::Store& store, const Revision& revision) {
  RIGCAL_ASSIGN(const auto newest, storage::LoadRevisionSummary(store, revision.robot, 0));
  if (newest && newest->number == revision.number) return true;
  RIGCAL_ASSIGN(const bool began_epoch, BeganEpochSince(store, revision.robot, revision.standing_watermark));
  if (began_epoch) return false;
  RIGCAL_ASSIGN(const bool gave_way, GaveWaySince(store, revision.robot, revision.standing_watermark));
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
