#include "server/pipeline/revisions/revision_due.h"

#include <algorithm>

#include "server/pipeline/attempt.h"
#include "storage/edges/edges.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/standing.h"
#include "storage/work/attempts.h"
#include "storage/work/jobs.h"

namespace rigcal::pipeline {
namespace {

constexpr std::int64_t kUnsolvedMax_ns = 45'000'000'000;
constexpr std::int64_t kPressing_ns = 10'000'000'000;
constexpr std::int64_t kReportLater_ns = 60'000'000'000;

using AttemptCounts = std::map<std::string, int>;

bool IsGivenUp(const AttemptCounts& counts, const std::string& work, int attempts_max) {
  const auto count = counts.find(work);
  return count != counts.end() && count->second >= attempts_max;
}

Result<bool> CanBeRevised(storage::Store& store, Stamp now, const RobotId& robot, const AttemptCounts& counts) {
  RIGCAL_ASSIGN(const std::int64_t jobs, storage::CountJobs(store, robot));
  RIGCAL_ASSIGN(const bool due, IsRevisionDue(store, now, robot, jobs));
  if (!due) return false;
  RIGCAL_ASSIGN(const std::int64_t edges, storage::LoadEdgeWatermark(store, robot));
  RIGCAL_ASSIGN(const std::int64_t standing, storage::LoadStandingWatermark(store, robot));
  return !IsGivenUp(counts, storage::WorkOfRevision(robot, edges, standing), kAttemptsMax);
}

// How long the report has waited that waits longest; 0: none waits.
Result<std::int64_t> ReportWaited_ns(storage::Store& store, Stamp now, const AttemptCounts& counts) {
  RIGCAL_ASSIGN(const auto unpublished, storage::LoadUnpublished(store));
  const auto first = std::find_if(unpublished.begin(), unpublished.end(), [&](const storage::RevisionKey& key) {
    return !IsGivenUp(counts, storage::WorkOfReport(key), kPublishAttemptsMax);
  });
  if (first == unpublished.end()) return 0;
  RIGCAL_ASSIGN(const auto revision, storage::LoadRevisionSummary(store, first->robot, first->number));
  return revision ? now.ns - revision->created_at.ns : 0;
}

}  // namespace

Result<bool> IsRevisionDue(storage::Store& store, Stamp now, const RobotId& robot, std::int64_t jobs) {
  if (jobs == 0) return true;
  RIGCAL_ASSIGN(const auto since, storage::LoadUnsolvedSince(store, robot));
  const std::int64_t waited_ns = since ? now.ns - since->ns : 0;
  return waited_ns >= kUnsolvedMax_ns || waited_ns < 0;  // the clock was set back
}

Result<bool> IsRevisionPressing(storage::Store& store, Stamp now, const std::vector<RobotId>& taken) {
  RIGCAL_ASSIGN(const auto unsolved, storage::LoadUnsolvedRobots(store));
  if (unsolved.empty()) return false;
  RIGCAL_ASSIGN(const AttemptCounts counts, storage::LoadAttemptCounts(store));
  for (const RobotId& robot : unsolved) {
    RIGCAL_ASSIGN(const auto since, storage::LoadUnsolvedSince(store, robot));
    if (!since || std::find(taken.begin(), taken.end(), robot) != taken.end()) continue;
    const std::int64_t waited_ns = now.ns - since->ns;
    if (waited_ns < kPressing_ns) return false;  // as have all behind it
    RIGCAL_ASSIGN(const bool can_be, CanBeRevised(store, now, robot, counts));
    if (!can_be) continue;
    RIGCAL_ASSIGN(const std::int64_t report_waited_ns, ReportWaited_ns(store, now, counts));
    return report_waited_ns < waited_ns + kReportLater_ns;
  }
  return false;
}

}  // namespace rigcal::pipeline
