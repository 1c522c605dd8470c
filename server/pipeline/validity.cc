#include "server/pipeline/validity.h"

#include <algorithm>
#include <set>

#include "server/pipeline/session_refinement.h"
#include "storage/jobs.h"
#include "storage/revisions.h"
#include "storage/session_estimates.h"
#include "storage/sessions.h"

namespace rigcal::pipeline {
namespace {

// Whether a session that came after `solved_at` says that a sensor was moved on purpose.
Result<bool> WasRemountedAfter(storage::Store& store, const RobotId& robot, Stamp solved_at) {
  RIGCAL_ASSIGN(const auto remounts, storage::LoadRemounts(store, robot));
  if (remounts.empty()) return false;
  std::set<SessionId> named;
  for (const storage::Remount& remount : remounts) named.insert(remount.session);
  RIGCAL_ASSIGN(const auto sessions, storage::LoadSessions(store, robot));
  return std::any_of(sessions.begin(), sessions.end(), [&](const storage::SessionRow& session) {
    return named.contains(session.id) && session.closed_at > solved_at;
  });
}

// Whether a sensor gave way during a session that came after `solved_at`: what was known of it before holds no more.
Result<bool> GaveWayAfter(storage::Store& store, const RobotId& robot, Stamp solved_at) {
  RIGCAL_ASSIGN(const auto rows, storage::LoadSessionEstimates(store, robot, kSessionEstimator, kSessionsRefined));
  for (const storage::SessionEstimateRow& row : rows) {
    if (!row.estimate || row.estimate->moved.empty()) continue;
    RIGCAL_ASSIGN(const auto session, storage::LoadSession(store, row.session));
    if (session && session->closed_at > solved_at) return true;
  }
  return false;
}

}  // namespace

Result<std::optional<UsableRevision>> LoadUsable(storage::Store& store, const Revision& revision) {
  if (IsUsable(revision.verdict)) return UsableRevision{revision.number, revision.created_at};
  RIGCAL_ASSIGN(const auto usable, storage::LoadUsableRevision(store, revision.robot, revision.number));
  if (!usable) return std::nullopt;
  RIGCAL_ASSIGN(const bool remounted, WasRemountedAfter(store, revision.robot, usable->created_at));
  if (remounted) return std::nullopt;
  RIGCAL_ASSIGN(const bool gave_way, GaveWayAfter(store, revision.robot, usable->created_at));
  if (gave_way) return std::nullopt;
  return UsableRevision{usable->number, usable->created_at};
}

Result<bool> IsCalculating(storage::Store& store, const RobotId& robot) {
  RIGCAL_ASSIGN(const std::int64_t jobs, storage::CountJobs(store, robot));
  if (jobs > 0) return true;
  return storage::IsUnsolved(store, robot);
}

Result<Validity> LoadValidity(storage::Store& store, const Revision& revision, Stamp now) {
  Validity validity;
  validity.calibrated_at = revision.calibrated_at;
  validity.overdue = IsOverdue(validity.calibrated_at, kDefaultMaxAge_ns, now);
  RIGCAL_ASSIGN(validity.usable, LoadUsable(store, revision));
  RIGCAL_ASSIGN(validity.calculating, IsCalculating(store, revision.robot));
  return validity;
}

}  // namespace rigcal::pipeline
