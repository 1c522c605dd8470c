#include "server/pipeline/recomputation/drain.h"

#include "server/base/log.h"
#include "server/formats/answers/answers.h"
#include "server/formats/boards/square_sizes.h"
#include "server/metrics/noted.h"
#include "server/pipeline/attempt.h"
#include "server/pipeline/edges/lost_payloads.h"
#include "server/pipeline/revisions/revise.h"
#include "server/pipeline/robots/summaries.h"
#include "server/pipeline/robots/validity.h"
#include "server/pipeline/sessions/session_refinement.h"
#include "server/pipeline/step_log.h"
#include "server/pipeline/workers/worker.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/session_estimates.h"
#include "storage/sessions/sessions.h"
#include "storage/work/attempts.h"
#include "storage/work/jobs.h"

namespace rigcal::pipeline {
namespace {

using storage::RecomputationItem;

// No robot's name: one piece at a time.
const RobotId kRecomputes("//");

// Whoever hears of the candidate finds it in the lists.
Status TellCandidate(const StepContext& context, const RobotId& robot, int number) {
  if (const Status kept = RefreshSummary(context.store, context.clock, robot); !kept) LogError(kept.error());
  RIGCAL_ASSIGN(const auto revision, storage::LoadRevisionSummary(context.store, robot, number));
  RIGCAL_ASSIGN(const auto usable, LoadUsable(context.store, robot));
  if (revision) {
    LogRevision(*revision);
    context.announcer.event(robot, "revision", std::to_string(number), formats::WriteRevisionEvent(*revision, usable));
  }
  context.announcer.state(robot);
  return {};
}

Status FinishRobotAnew(const StepContext& context, const RecomputationItem& item) {
  RIGCAL_ASSIGN(const RecomputedRobot done,
                metrics::Timed(metrics::Stage::kSolve, [&] { return ReviseAnew(context.store, item, context.clock); }));
  LogInfo("robot " + item.robot.str() + ": re-computed, " + NameOf(done.how));
  return done.revision > 0 ? TellCandidate(context, item.robot, done.revision) : Status();
}

// Where the process that does it ends, the attempt has failed.
Status SessionBy(const StepContext& context, const RecomputationItem& item) {
  if (context.workers == nullptr) return RecomputeSession(context.store, item, context.clock, context.cameras);
  const auto outcome = RunElsewhere(context, item.robot, RecomputeOrder(item.number));
  return outcome.said ? Status{} : Fail(outcome.said.error());
}

Status GiveUpAnew(const StepContext& context, const RecomputationItem& item) {
  const std::string work = storage::WorkOfRecomputation(item);
  RIGCAL_ASSIGN(const storage::Attempts attempts, storage::LoadAttempts(context.store, work));
  const std::string what = item.session.empty() ? "solved robot " + item.robot.str() + " anew"
                                                : "computed session " + item.session.str() + " again";
  const Error why = {ErrorCode::kInternal, WhyGivenUp(attempts, what), "Report this with the log of the server."};
  LogError(why);
  const Stamp now = context.clock.Now();
  return context.store.Write([&]() -> Status {
    RIGCAL_TRY(storage::EndAttempt(context.store, work, storage::AttemptEnd::kDone, "", now));
    if (item.session.empty())
      return storage::FinishRecomputedRobot(context.store, item, {item.robot, RobotAnew::kFailed, 0, 0, why.what, {}},
                                            0, now);
    return storage::FinishRecomputedSession(context.store, item, SessionAnew::kFailed, why.what, now);
  });
}

// By another version of the software than the one that was asked: its sessions would not be those that the run names.
bool IsOfThisSoftware(const RecomputationItem& item) { return item.estimator == kSessionEstimator; }

Status WorkOnItem(const StepContext& context, const RecomputationItem& item) {
  const std::string work = storage::WorkOfRecomputation(item);
  RIGCAL_ASSIGN(const auto counts, storage::LoadAttemptCounts(context.store));
  const auto found = counts.find(work);
  const int before = found == counts.end() ? 0 : found->second;
  if (before >= kAttemptsMax) return GiveUpAnew(context, item);
  const std::string said =
      item.session.empty() ? "robot " + item.robot.str() + " anew" : "session " + item.session.str() + " again";
  return Attempted(context.store, context.clock, work, said, before, [&]() -> Status {
    return item.session.empty() ? FinishRobotAnew(context, item) : SessionBy(context, item);
  });
}

// Ended as it is: the newer software is asked anew.
Status PassOver(const StepContext& context, const RecomputationItem& item) {
  const std::string why = "The server was updated meanwhile: ask once more.";
  return context.store.Write([&]() -> Status {
    if (!item.session.empty())
      return storage::FinishRecomputedSession(context.store, item, SessionAnew::kKept, why, context.clock.Now());
    return storage::FinishRecomputedRobot(context.store, item, {item.robot, RobotAnew::kFailed, 0, 0, why, {}}, 0,
                                          context.clock.Now());
  });
}

// What came of it, before it is stored.
struct ComputedAnew {
  SessionAnew how = SessionAnew::kSame;
  std::string why;
  std::optional<SessionEstimate> estimate;
  std::optional<Manifest> manifest;  // that `lost` points into
  std::vector<LostFile> lost;
};

// The store failed. Where files of the session are lost that is why, and it is kept; else it is tried again.
Result<ComputedAnew> KeptFor(const Error& error, storage::Store& store, const RecomputationItem& item) {
  ComputedAnew kept{SessionAnew::kKept, "", {}, {}, {}};
  RIGCAL_ASSIGN(kept.manifest, storage::LoadManifest(store, item.session));
  if (!kept.manifest) return Fail(error);
  std::vector<const Payload*> payloads;
  for (const Payload& payload : kept.manifest->payloads) payloads.push_back(&payload);
  RIGCAL_ASSIGN(kept.lost, FindLost(store, payloads));
  if (kept.lost.empty()) return Fail(error);
  kept.why = TellLost(item.robot, kept.lost).what + ". Push the session again, then ask once more.";
  return kept;
}

Result<ComputedAnew> ComputeAnew(storage::Store& store, const RecomputationItem& item, calib::CameraMemory& cameras) {
  RIGCAL_ASSIGN(const bool is_there,
                storage::HasSessionEstimate(store, item.session, storage::EstimatorNamed(item.estimator, item.sizes)));
  if (is_there) return ComputedAnew{};
  RIGCAL_ASSIGN(const SquareSizes sizes, formats::ReadSquareSizes(item.sizes));
  auto estimate = EstimateStored(store, item.session, sizes, cameras);
  if (!estimate)
    return estimate.error().code == ErrorCode::kStorage ? KeptFor(estimate.error(), store, item)
                                                        : Fail(estimate.error());
  if (*estimate) return ComputedAnew{SessionAnew::kComputed, "", std::move(*estimate), {}, {}};
  return ComputedAnew{
      SessionAnew::kKept, "Its pairs are not all calibrated, or wait for files that were lost.", {}, {}, {}};
}

}  // namespace

Result<StepResult> RecomputeNext(const StepContext& context) {
  StepResult result;
  const RobotLock alone(context.locks, kRecomputes);
  if (!alone.taken()) return result;
  RIGCAL_ASSIGN(const auto busy, BusyRobots(context));
  RIGCAL_ASSIGN(const auto item, storage::LoadNextRecomputation(context.store, busy));
  if (!item) return result;
  const LeasedRobot lock(context.locks, context.leases, context.store, item->robot);
  if (!lock.taken()) return result;
  RIGCAL_ASSIGN(const std::int64_t jobs, storage::CountJobs(context.store, item->robot));
  if (jobs > 0) return result;  // what was pushed comes first
  const Status done =
      Guarded([&] { return IsOfThisSoftware(*item) ? WorkOnItem(context, *item) : PassOver(context, *item); });
  result.worked = done.has_value();
  if (!done) result.wake_at = BackOff(context, item->robot, done.error());
  return result;
}

Status RecomputeSession(storage::Store& store, const RecomputationItem& item, const Clock& clock,
                        calib::CameraMemory& cameras) {
  RIGCAL_ASSIGN(const ComputedAnew done, ComputeAnew(store, item, cameras));
  return store.Write([&]() -> Status {
    const Stamp now = clock.Now();
    if (done.estimate)
      RIGCAL_TRY(storage::AppendSessionEstimate(store, *done.estimate,
                                                storage::EstimatorNamed(item.estimator, item.sizes), now));
    RIGCAL_TRY(AppendLost(store, done.lost, std::nullopt, now));
    RIGCAL_TRY(storage::EndAttempt(store, storage::WorkOfRecomputation(item), storage::AttemptEnd::kDone, "", now));
    return storage::FinishRecomputedSession(store, item, done.how, done.why, now);
  });
}

}  // namespace rigcal::pipeline
