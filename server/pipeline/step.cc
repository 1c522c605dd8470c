#include "server/pipeline/step.h"

#include <algorithm>

#include "server/base/limits_in_force.h"
#include "server/base/log.h"
#include "server/formats/answers/answers.h"
#include "server/metrics/noted.h"
#include "server/pipeline/attempt.h"
#include "server/pipeline/edges/run_edge_job.h"
#include "server/pipeline/recomputation/drain.h"
#include "server/pipeline/reports/kept_reports.h"
#include "server/pipeline/reports/publish.h"
#include "server/pipeline/revisions/revise.h"
#include "server/pipeline/revisions/revision_due.h"
#include "server/pipeline/robots/robot_rows.h"
#include "server/pipeline/robots/validity.h"
#include "server/pipeline/sessions/session_refinement.h"
#include "server/pipeline/step_log.h"
#include "server/pipeline/workers/worker.h"
#include "storage/edges/edges.h"
#include "storage/revisions/revisions.h"
#include "storage/sessions/standing.h"
#include "storage/settings/policies.h"
#include "storage/work/jobs.h"

namespace rigcal::pipeline {
namespace {

// No robot's name: of work that was begun before and not finished one piece is done at a time, so that what kills the
// process is not held against its neighbours for ever.
const RobotId kBegunBefore;

Status UpdateLive(const StepContext& context, const RobotId& robot) {
  RIGCAL_ASSIGN(const RobotGraph loaded, LoadRobotGraph(context.store, robot));
  LiveGraph& live = context.live.Of(robot);
  if (live.watermark >= loaded.watermark && live.standing_watermark >= loaded.standing_watermark) return {};
  TakeNewEdges(loaded, live);
  context.announcer.event(
      robot, "graph_update", robot.str(),
      formats::WriteGraphEvent(robot, static_cast<std::int64_t>(loaded.edges.size()), live.solver->Snapshot()));
  return {};
}

// What an update left undone to keep to its budget is made up for once the robot is at rest.
void SettleLive(const StepContext& context, const RobotId& robot) {
  const LiveGraph& live = context.live.Of(robot);
  if (live.solver != nullptr && !live.solver->settled()) live.solver->Settle();
}

int CountOf(const std::map<std::string, int>& attempts, const std::string& work) {
  const auto found = attempts.find(work);
  return found == attempts.end() ? 0 : found->second;
}

Status PublishBy(const StepContext& context, const storage::RevisionKey& key, const std::string& why_no_clouds) {
  if (context.workers != nullptr) {
    const auto outcome = RunElsewhere(context, key.robot, PublishOrder(key, why_no_clouds));
    return outcome.said ? Status{} : Fail(outcome.said.error());
  }
  RIGCAL_TRY(Publish(context.store, key, context.clock, why_no_clouds));
  return {};
}

Status PublishOnce(const StepContext& context, const storage::RevisionKey& key, int before) {
  const std::string work = storage::WorkOfReport(key);
  const std::string said = "revision " + std::to_string(key.number) + " of robot " + key.robot.str();
  std::string why_no_clouds;
  RIGCAL_ASSIGN(const auto revision, storage::LoadRevisionSummary(context.store, key.robot, key.number));
  if (revision && !IsJudged(*revision)) why_no_clouds = "The clouds in colour are shown when all pairs are calibrated.";
  if (before >= kAttemptsMax) {
    RIGCAL_ASSIGN(const storage::Attempts attempts, storage::LoadAttempts(context.store, work));
    why_no_clouds = "The clouds in colour are not shown: " + WhyGivenUp(attempts, "made this report") + ".";
  }
  return Attempted(
      context.store, context.clock, work, said + (why_no_clouds.empty() ? "" : " without its clouds"),
      before % kAttemptsMax,
      [&] { return metrics::Timed(metrics::Stage::kReport, [&] { return PublishBy(context, key, why_no_clouds); }); });
}

// When a robot has a new one; an older one that somebody asked for stays until then.
void RemoveOld(const StepContext& context, const storage::RevisionKey& published) {
  const RobotId& robot = published.robot;
  const auto newest = storage::LoadRevisionSummary(context.store, robot, 0);
  if (!newest || !*newest || (*newest)->number != published.number) return;
  const auto freed = RemoveOldReports(context.store, robot, limits::InForce().reports_of_robot);
  if (!freed) return LogError(freed.error());
  if (freed->reports > 0)
    LogInfo("robot " + robot.str() + ": " + std::to_string(freed->reports) + " older reports removed, " +
            std::to_string(freed->bytes / 1024) + " KiB freed; they are drawn again when they are asked for");
}

// An older report that somebody asked for, as it is kept no more.
Result<bool> IsOlderAgain(const StepContext& context, const storage::RevisionKey& key) {
  RIGCAL_ASSIGN(const bool published, storage::IsPublished(context.store, key));
  RIGCAL_ASSIGN(const auto newest, storage::LoadRevisionSummary(context.store, key.robot, 0));
  return published && newest && newest->number != key.number;
}

// Where other processes share the store, one of them may have done it between the look at the list and the lease.
template <typename LoadList, typename IsIt>
Result<bool> StillWaits(const StepContext& context, const LoadList& load_list, const IsIt& is_it) {
  if (context.leases == nullptr) return true;
  RIGCAL_ASSIGN(const auto list, load_list());
  return std::any_of(list.begin(), list.end(), is_it);
}

// A revision that cannot be published holds up no other: it is passed over, and its error is the result if nothing
// worked. `last`: those that were begun before, and older ones again, when there is nothing else to do.
Result<bool> PublishNext(const StepContext& context, bool last) {
  RIGCAL_ASSIGN(const auto unpublished, storage::LoadUnpublished(context.store));
  if (unpublished.empty()) return false;
  RIGCAL_ASSIGN(const auto attempts, storage::LoadAttemptCounts(context.store));
  std::optional<Error> problem;
  for (const storage::RevisionKey& key : unpublished) {
    const int before = CountOf(attempts, storage::WorkOfReport(key));
    RIGCAL_ASSIGN(const bool again, IsOlderAgain(context, key));
    if ((before > 0 || again) != last || before >= kPublishAttemptsMax) continue;
    const LeasedRobot lock(context.locks, context.leases, context.store, key.robot);
    if (!lock.taken()) continue;
    RIGCAL_ASSIGN(const bool waits,
                  StillWaits(
                      context, [&] { return storage::LoadUnpublished(context.store); },
                      [&](const auto& one) { return one.robot == key.robot && one.number == key.number; }));
    if (!waits) continue;
    const LogAbout about({.robot = key.robot.str()});
    if (const Status published = PublishOnce(context, key, before); !published) {
      if (context.undrawn != nullptr) context.undrawn->Note(key, published.error());
      if (published.error().code == ErrorCode::kUnreachable)
        static_cast<void>(BackOff(context, key.robot, published.error()));  // says so
      else
        problem = published.error();
      continue;
    }
    if (context.undrawn != nullptr) context.undrawn->Forget(key);
    const std::string path = "/robots/" + key.robot.str() + "/revisions/" + std::to_string(key.number) + "/";
    context.announcer.event(key.robot, "published", std::to_string(key.number),
                            formats::WritePublishedEvent(key.robot, key.number, path));
    RemoveOld(context, key);
    return true;
  }
  if (problem) return Fail(*problem);
  return false;
}

Result<bool> PublishBegunBefore(const StepContext& context) {
  const RobotLock alone(context.locks, kBegunBefore);
  return alone.taken() ? PublishNext(context, true) : Result<bool>(false);
}

// Without its refinement a session is what its edges say, as is one that cannot be refined. A fault of ours is an
// error.
Status Refine(const StepContext& context, const RobotId& robot) {
  const Status refined = Guarded([&]() -> Status {
    if (context.workers == nullptr) return RefineSessions(context.store, robot, context.cameras, context.clock);
    const auto outcome = RunElsewhere(context, robot, RefineOrder(robot));
    return outcome.said ? Status{} : Fail(outcome.said.error());
  });
  if (refined || IsOurFault(refined.error())) return refined;
  LogError(refined.error());
  return {};
}

// `refine`: not where that has failed so often that it is given up, nor are all edges merged anew then or later.
Status ReviseAndTell(const StepContext& context, const RobotId& robot, std::int64_t jobs, bool refine) {
  if (jobs == 0 && refine) RIGCAL_TRY(Refine(context, robot));
  RIGCAL_ASSIGN(const Revision revision, Revise(context.store, robot, context.clock, jobs, refine));
  LogRevision(revision);
  // Whoever hears of it finds it in the lists.
  if (const Status kept = RefreshSummary(context.store, context.clock, robot); !kept) LogError(kept.error());
  RIGCAL_ASSIGN(const auto usable, LoadUsable(context.store, robot));
  context.announcer.event(robot, "revision", std::to_string(revision.number),
                          formats::WriteRevisionEvent(revision, usable));
  context.announcer.state(robot);
  return {};
}

Status SolveBurst(const StepContext& context, const RobotId& robot, bool due, std::int64_t jobs, bool refine) {
  RIGCAL_TRY(UpdateLive(context, robot));
  if (!due) return {};
  RIGCAL_TRY(ReviseAndTell(context, robot, jobs, refine));
  SettleLive(context, robot);
  return {};
}

// A graph that ended the process so often is left as it is until another edge or session of the robot counts.
Result<bool> SolveCounted(const StepContext& context, const RobotId& robot, bool due, std::int64_t jobs) {
  RIGCAL_ASSIGN(const std::int64_t edges, storage::LoadEdgeWatermark(context.store, robot));
  RIGCAL_ASSIGN(const std::int64_t standing, storage::LoadStandingWatermark(context.store, robot));
  const std::string work = storage::WorkOfRevision(robot, edges, standing);
  RIGCAL_ASSIGN(const auto attempts, storage::LoadAttemptCounts(context.store));
  const int before = CountOf(attempts, work);
  if (before >= kAttemptsMax) return false;
  const auto body = [&]() -> Status {
    RIGCAL_TRY(metrics::Timed(metrics::Stage::kSolve,
                              [&] { return SolveBurst(context, robot, due, jobs, before + 1 < kAttemptsMax); }));
    return storage::EndAttempt(context.store, work, storage::AttemptEnd::kDone, "", context.clock.Now());
  };
  RIGCAL_TRY(Attempted(context.store, context.clock, work, "the graph of robot " + robot.str(), before, body));
  return due;
}

// The live state of one robot, and its revision if one is due. True if it was revised. The live state of a graph
// that this process has solved before is told at once, and not counted.
Result<bool> WorkOn(const StepContext& context, const RobotId& robot) {
  const bool known = context.live.Of(robot).solver != nullptr;
  if (known) RIGCAL_TRY(UpdateLive(context, robot));
  RIGCAL_ASSIGN(const std::int64_t jobs, storage::CountJobs(context.store, robot));
  RIGCAL_ASSIGN(const bool due, IsRevisionDue(context.store, context.clock.Now(), robot, jobs));
  if (known && !due) return false;
  return SolveCounted(context, robot, due, jobs);
}

void WakeBy(std::optional<Stamp> stamp, StepResult& result) {
  if (stamp && (!result.wake_at || *stamp < *result.wake_at)) result.wake_at = stamp;
}

// A lease is taken and given back on disk, and who takes no jobs must not keep others from them: not for a robot of
// which there is nothing to do yet. Its live state is told with its jobs.
bool IsWorthTaking(const StepContext& context, const RobotId& robot) {
  const auto jobs = storage::CountJobs(context.store, robot);
  const Result<bool> due = jobs ? IsRevisionDue(context.store, context.clock.Now(), robot, *jobs) : Result<bool>(true);
  return !due || *due;
}

using LoadRobots = std::function<Result<std::vector<RobotId>>()>;

// The first of these that nobody works on and that is due. `load_robots`: those that wait, now.
StepResult ReviseOneOf(const StepContext& context, const std::vector<RobotId>& robots, const LoadRobots& load_robots) {
  StepResult result;
  for (const RobotId& robot : robots) {
    if ((context.leases != nullptr || !context.takes_jobs) && !IsWorthTaking(context, robot)) continue;
    const LeasedRobot lock(context.locks, context.leases, context.store, robot);
    if (!lock.taken() ||
        !StillWaits(context, load_robots, [&](const RobotId& one) { return one == robot; }).value_or(false))
      continue;
    const LogAbout about({.robot = robot.str()});
    const Result<bool> revised = Guarded([&] { return WorkOn(context, robot); });
    if (!revised) WakeBy(BackOff(context, robot, revised.error()), result);
    result.worked = revised && *revised;
    if (result.worked) return result;
  }
  return result;
}

Result<StepResult> ReviseNext(const StepContext& context) {
  const auto load = [&] { return storage::LoadUnsolvedRobots(context.store); };
  RIGCAL_ASSIGN(const auto unsolved, load());
  return ReviseOneOf(context, unsolved, load);
}

// Robots for which a policy of their fleet or rig model was set: there may be very many of them.
Result<StepResult> JudgeNext(const StepContext& context) {
  constexpr int kAtOnce = 64;
  StepResult result;
  for (RobotId after;;) {
    const auto load = [&] { return storage::LoadRobotsToJudge(context.store, after, kAtOnce); };
    RIGCAL_ASSIGN(const auto waiting, load());
    const StepResult some = ReviseOneOf(context, waiting, load);
    WakeBy(some.wake_at, result);
    result.worked = some.worked;
    if (result.worked || waiting.size() < kAtOnce) return result;
    after = waiting.back();
  }
}

// A session is told of when the first of its pairs is taken up: then it came whole and is on disk.
Status TellOfSession(const StepContext& context, const storage::JobRow& job) {
  RIGCAL_ASSIGN(const auto session, LoadSessionRow(context.store, job.session));
  if (session.jobs_waiting < session.jobs_total) return {};
  context.announcer.event(job.robot, "session_closed", job.session.str(), formats::WriteSessionEvent(session));
  return {};
}

// Where the process that does it ends, the attempt has failed; what was begun too often is only noted as such.
Result<Edge> EdgeOfJob(const StepContext& context, const storage::JobRow& job) {
  if (context.workers == nullptr || job.attempts >= kAttemptsMax)
    return RunEdgeJob(context.store, job, context.clock, context.cameras);
  const WorkerPool::Outcome outcome = RunElsewhere(context, job.robot, JobOrder(job));
  if (outcome.died) EndAttempt(context.store, context.clock, storage::WorkOfJob(job.number), outcome.said.error());
  if (!outcome.said) return Fail(outcome.said.error());
  RIGCAL_ASSIGN(auto edge, storage::LoadEdge(context.store, EdgeId(*outcome.said)));
  if (edge) return std::move(*edge);
  return Fail(ErrorCode::kInternal, "the edge of job " + std::to_string(job.number) + " is not in the store",
              "Report this with the log of the server.");
}

Status RunJob(const StepContext& context, const storage::JobRow& job) {
  RIGCAL_TRY(TellOfSession(context, job));
  RIGCAL_ASSIGN(const Edge edge, metrics::Timed(metrics::Stage::kCalibrate, [&] { return EdgeOfJob(context, job); }));
  LogEdge(edge);
  RIGCAL_ASSIGN(const storage::JobCount jobs, storage::CountJobs(context.store, job.session));
  context.announcer.event(job.robot, "edge", edge.id.str(), formats::WriteEdgeEvent(edge, jobs.waiting, jobs.total));
  if (context.live.Of(job.robot).solver == nullptr) return {};  // WorkOn makes it next, and counts the attempt
  return UpdateLive(context, job.robot);
}

Result<StepResult> RunNextJob(const StepContext& context) {
  StepResult result;
  RIGCAL_ASSIGN(const auto busy, BusyRobots(context));
  RIGCAL_ASSIGN(const auto job, storage::LoadNextJob(context.store, busy, context.locks.Served()));
  if (!job) return result;
  // Another thread was faster: look again at once; another process, or no lease to be had: when there is news, or soon.
  result.worked = context.leases == nullptr;
  const LeasedRobot lock(context.locks, context.leases, context.store, job->robot);
  if (!lock.taken()) return result;
  result.worked = true;
  RIGCAL_ASSIGN(const bool waits, storage::IsJobWaiting(context.store, job->number));
  if (!waits) return result;
  context.locks.Serve(job->robot);
  const LogAbout about({.robot = job->robot.str(), .session = job->session.str(), .job = std::to_string(job->number)});
  std::optional<RobotLock> alone;
  if (job->attempts > 0 && !alone.emplace(context.locks, kBegunBefore).taken()) return StepResult{};
  const Status ran = Guarded([&] { return RunJob(context, *job); });
  if (!ran) WakeBy(BackOff(context, job->robot, ran.error()), result);
  return result;
}

}  // namespace

Result<std::vector<RobotId>> BusyRobots(const StepContext& context) {
  std::vector<RobotId> busy = context.locks.Taken();
  if (context.leases == nullptr) return busy;
  RIGCAL_ASSIGN(const auto others, storage::LoadLeasedByOthers(context.store, context.leases->owner()));
  busy.insert(busy.end(), others.begin(), others.end());
  return busy;
}

WorkerPool::Outcome RunElsewhere(const StepContext& context, const RobotId& robot, const std::string& order) {
  const auto lease = context.leases == nullptr ? std::nullopt : context.leases->HeldOf(robot);
  return context.workers->Run(lease ? LeasedOrder(*lease, order) : order);
}

Stamp BackOff(const StepContext& context, const RobotId& robot, const Error& error) {
  constexpr std::int64_t kRest_ns = 10'000'000'000;
  LogError({error.code, "robot " + robot.str() + ": " + error.what, error.cure});
  const Stamp until{context.clock.Now().ns + kRest_ns};
  context.locks.Rest(robot, until);
  return until;
}

namespace {

// What else came of robots is in the lists soon after, few at a time. True if there is more of it.
bool RefreshOthers(const StepContext& context) {
  constexpr int kSummariesOfStep = 64;
  SummaryTurn alone;
  SummaryTurn& turn = context.summaries == nullptr ? alone : *context.summaries;
  const std::unique_lock lock(turn.taken, std::try_to_lock);
  if (!lock) return false;
  const auto refreshed = RefreshSummaries(context.store, context.clock, kSummariesOfStep, turn);
  if (!refreshed) LogError(refreshed.error());
  return refreshed && refreshed->more;
}

// What may take for hours, and what can wait as long.
Result<StepResult> RunJobOrLess(const StepContext& context) {
  RIGCAL_ASSIGN(StepResult ran, RunNextJob(context));
  if (ran.worked) return ran;
  RIGCAL_ASSIGN(const bool again, PublishBegunBefore(context));
  if (again) return StepResult{true, std::nullopt};
  RIGCAL_ASSIGN(const StepResult judged, JudgeNext(context));
  if (judged.worked) return judged;
  return RecomputeNext(context);
}

Result<StepResult> DoNext(const StepContext& context) {
  context.locks.EndRests(context.clock.Now());
  RIGCAL_ASSIGN(const bool pressing, IsRevisionPressing(context.store, context.clock.Now(), context.locks.Taken()));
  if (pressing) {
    RIGCAL_ASSIGN(StepResult first, ReviseNext(context));
    if (first.worked) return first;
  }
  const Result<bool> published = PublishNext(context, false);
  if (published && *published) return StepResult{true, std::nullopt};
  RIGCAL_ASSIGN(StepResult revised, ReviseNext(context));
  if (revised.worked) return revised;
  if (context.takes_jobs) {
    RIGCAL_ASSIGN(const StepResult done, RunJobOrLess(context));
    if (done.worked) return done;
  }
  if (!published) return Fail(published.error());
  WakeBy(context.locks.NextRestEnd(), revised);
  return revised;
}

}  // namespace

Result<StepResult> Step(const StepContext& context) {
  // Another process may have gone, or stand still; a robot may be due while all others are amid their jobs.
  constexpr std::int64_t kLookAgain_ns = 2'000'000'000;
  Result<StepResult> done = DoNext(context);
  if (done && (context.leases != nullptr || !context.takes_jobs))
    WakeBy(Stamp{context.clock.Now().ns + kLookAgain_ns}, *done);
  const bool more = RefreshOthers(context);
  if (done && more) done->worked = true;
  return done;
}

}  // namespace rigcal::pipeline
