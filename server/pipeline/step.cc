#include "server/pipeline/step.h"

#include <algorithm>

#include "server/base/log.h"
#include "server/formats/answers.h"
#include "server/pipeline/publish.h"
#include "server/pipeline/revise.h"
#include "server/pipeline/robot_rows.h"
#include "server/pipeline/run_edge_job.h"
#include "server/pipeline/validity.h"
#include "storage/edges.h"
#include "storage/jobs.h"
#include "storage/revisions.h"

namespace rigcal::pipeline {
namespace {

// The rest of a batch of edges whose sender went silent is waited for this long before the robot is revised without it.
constexpr std::int64_t kBatchQuiet_ns = 5'000'000'000;

class Claim {
 public:
  Claim(Claims& claims, const RobotId& robot) : claims_(claims), robot_(robot), taken_(claims.Take(robot)) {}
  ~Claim() {
    if (taken_) claims_.GiveBack(robot_);
  }
  Claim(const Claim&) = delete;
  Claim& operator=(const Claim&) = delete;
  [[nodiscard]] bool taken() const { return taken_; }

 private:
  Claims& claims_;
  RobotId robot_;
  bool taken_;
};

// What a library throws costs this step, not the server.
template <typename Work>
auto Guarded(const Work& work) -> decltype(work()) {
  try {
    return work();
  } catch (const std::exception& exception) {
    return Fail(ErrorCode::kInternal, std::string("the work broke off: ") + exception.what(),
                "Report this with the log of the server.");
  }
}

Status UpdateLive(const StepContext& context, const RobotId& robot) {
  RIGCAL_ASSIGN(const RobotGraph loaded, LoadRobotGraph(context.store, robot));
  LiveGraph& live = context.live.Of(robot);
  if (live.watermark >= loaded.watermark) return {};
  TakeNewEdges(loaded, live);
  context.announcer.event(
      robot, "graph_update", robot.str(),
      formats::WriteGraphEvent(robot, static_cast<std::int64_t>(loaded.edges.size()), live.solver->Glance()));
  return {};
}

// What an update left undone to keep to its budget is made up for once the robot is at rest.
void SettleLive(const StepContext& context, const RobotId& robot) {
  const LiveGraph& live = context.live.Of(robot);
  if (live.solver != nullptr && !live.solver->settled()) live.solver->Settle();
}

// A revision that cannot be published holds up no other: it is passed over, and its error is the result if nothing
// worked.
Result<bool> PublishNext(const StepContext& context) {
  RIGCAL_ASSIGN(const auto unpublished, storage::LoadUnpublished(context.store));
  std::optional<Error> problem;
  for (const storage::RevisionKey& key : unpublished) {
    const Claim claim(context.claims, key.robot);
    if (!claim.taken()) continue;
    const auto folder = Guarded([&] { return Publish(context.store, key, context.clock); });
    if (!folder) {
      problem = folder.error();
      continue;
    }
    const std::string path = "/robots/" + key.robot.str() + "/revisions/" + std::to_string(key.number) + "/";
    context.announcer.event(key.robot, "published", std::to_string(key.number),
                            formats::WritePublishedEvent(key.robot, key.number, path));
    return true;
  }
  if (problem) return Fail(*problem);
  return false;
}

// Is the burst over: no job of the robot waiting, no batch half arrived? Otherwise when to look again, if ever.
struct Burst {
  bool over = false;
  std::optional<Stamp> wake_at;
};
Result<Burst> BurstOf(const StepContext& context, const RobotId& robot) {
  RIGCAL_ASSIGN(const std::int64_t jobs, storage::CountJobs(context.store, robot));
  if (jobs > 0) return Burst{};
  RIGCAL_ASSIGN(const auto newest, storage::LoadOpenBatch(context.store, robot));
  if (!newest || context.clock.Now().ns - newest->ns >= kBatchQuiet_ns) return Burst{true, std::nullopt};
  return Burst{false, Stamp{newest->ns + kBatchQuiet_ns}};
}

Status ReviseAndTell(const StepContext& context, const RobotId& robot) {
  RIGCAL_ASSIGN(const Revision revision, Revise(context.store, robot, context.clock));
  RIGCAL_ASSIGN(const auto usable, LoadUsable(context.store, revision));
  context.announcer.event(robot, "revision", std::to_string(revision.number),
                          formats::WriteRevisionEvent(revision, usable));
  RIGCAL_ASSIGN(const auto document, formats::ReadRevisionDocument(revision.document));
  context.announcer.status(revision, static_cast<std::int64_t>(document.edges.size()));
  if (IsUsable(revision.verdict)) context.announcer.calibration(revision, document.reference, document.solution.poses);
  if (!usable) context.announcer.withdraw(robot, document.solution.poses);
  return {};
}

// The live state of one robot, and its revision if its burst is over.
Result<Burst> WorkOn(const StepContext& context, const RobotId& robot) {
  RIGCAL_TRY(UpdateLive(context, robot));
  RIGCAL_ASSIGN(const Burst burst, BurstOf(context, robot));
  if (!burst.over) return burst;
  RIGCAL_TRY(ReviseAndTell(context, robot));
  SettleLive(context, robot);
  return burst;
}

// A robot whose work failed rests, so that it holds up no other; then it is tried again.
Stamp LetRest(const StepContext& context, const RobotId& robot, const Error& error) {
  constexpr std::int64_t kRest_ns = 10'000'000'000;
  LogError({error.code, "robot " + robot.str() + ": " + error.what, error.cure});
  const Stamp until{context.clock.Now().ns + kRest_ns};
  context.claims.Rest(robot, until);
  return until;
}

void WakeBy(std::optional<Stamp> stamp, StepResult& result) {
  if (stamp && (!result.wake_at || *stamp < *result.wake_at)) result.wake_at = stamp;
}

Result<StepResult> ReviseNext(const StepContext& context) {
  StepResult result;
  RIGCAL_ASSIGN(const auto unsolved, storage::LoadUnsolvedRobots(context.store));
  for (const RobotId& robot : unsolved) {
    const Claim claim(context.claims, robot);
    if (!claim.taken()) continue;
    const Result<Burst> burst = Guarded([&] { return WorkOn(context, robot); });
    WakeBy(burst ? burst->wake_at : LetRest(context, robot, burst.error()), result);
    result.worked = burst && burst->over;
    if (result.worked) return result;
  }
  return result;
}

// A session is told of when the first of its pairs is taken up: then it came whole and is on disk.
Status TellOfSession(const StepContext& context, const storage::JobRow& job) {
  RIGCAL_ASSIGN(const auto session, LoadSessionRow(context.store, job.session));
  if (session.jobs_waiting < session.jobs_total) return {};
  context.announcer.event(job.robot, "session_closed", job.session.str(), formats::WriteSessionEvent(session));
  return {};
}

Status RunJob(const StepContext& context, const storage::JobRow& job) {
  RIGCAL_TRY(TellOfSession(context, job));
  RIGCAL_ASSIGN(const Edge edge, RunEdgeJob(context.store, job, context.clock, context.cameras));
  RIGCAL_ASSIGN(const storage::JobCount jobs, storage::CountJobs(context.store, job.session));
  context.announcer.event(job.robot, "edge", edge.id.str(), formats::WriteEdgeEvent(edge, jobs.waiting, jobs.total));
  return UpdateLive(context, job.robot);
}

Result<StepResult> RunNextJob(const StepContext& context) {
  StepResult result;
  RIGCAL_ASSIGN(const auto job, storage::LoadNextJob(context.store, context.claims.Taken()));
  if (!job) return result;
  result.worked = true;
  const Claim claim(context.claims, job->robot);
  if (!claim.taken()) return result;  // another thread was faster: look again
  if (const Status ran = RunJob(context, *job); !ran) WakeBy(LetRest(context, job->robot, ran.error()), result);
  return result;
}

}  // namespace

bool Claims::Take(const RobotId& robot) {
  const std::lock_guard lock(mutex_);
  return !resting_.contains(robot) && taken_.insert(robot).second;
}

void Claims::GiveBack(const RobotId& robot) {
  const std::lock_guard lock(mutex_);
  taken_.erase(robot);
}

std::vector<RobotId> Claims::Taken() const {
  const std::lock_guard lock(mutex_);
  std::vector<RobotId> robots(taken_.begin(), taken_.end());
  for (const auto& [robot, until] : resting_) robots.push_back(robot);
  return robots;
}

void Claims::Rest(const RobotId& robot, Stamp until) {
  const std::lock_guard lock(mutex_);
  resting_[robot] = until;
}

std::optional<Stamp> Claims::NextRestEnd() const {
  const std::lock_guard lock(mutex_);
  std::optional<Stamp> next;
  for (const auto& [robot, until] : resting_)
    if (!next || until < *next) next = until;
  return next;
}

void Claims::EndRests(Stamp now) {
  const std::lock_guard lock(mutex_);
  std::erase_if(resting_, [&](const auto& rest) { return rest.second <= now; });
}

Result<StepResult> Step(const StepContext& context) {
  context.claims.EndRests(context.clock.Now());
  const Result<bool> published = PublishNext(context);
  if (published && *published) return StepResult{true, std::nullopt};
  RIGCAL_ASSIGN(StepResult revised, ReviseNext(context));
  if (revised.worked) return revised;
  RIGCAL_ASSIGN(StepResult ran, RunNextJob(context));
  if (ran.worked) return ran;
  if (!published) return Fail(published.error());
  WakeBy(context.claims.NextRestEnd(), revised);
  return revised;
}

}  // namespace rigcal::pipeline
