#include "server/pipeline/step.h"

#include <algorithm>

#include "server/formats/answers.h"
#include "server/graph/solve.h"
#include "server/pipeline/publish.h"
#include "server/pipeline/revise.h"
#include "server/pipeline/run_edge_job.h"
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

Status UpdateLive(const StepContext& context, const RobotId& robot) {
  RIGCAL_ASSIGN(const RobotGraph loaded, LoadRobotGraph(context.store, robot));
  const auto previous = context.live.Get(robot);
  if (previous && previous->watermark >= loaded.watermark) return {};
  graph::SolveOptions options;
  options.marginals = false;
  LiveGraph live;
  live.watermark = loaded.watermark;
  live.solution = previous ? graph::Update(loaded.graph, previous->solution, options) : graph::Solve(loaded.graph, options);
  context.announcer.event(robot, "graph_update", robot.str(),
                          formats::WriteGraphEvent(robot, static_cast<std::int64_t>(loaded.edges.size()), live.solution));
  context.live.Set(robot, std::move(live));
  return {};
}

// A revision that cannot be published holds up no other: it is passed over, and its error is the result if nothing worked.
Result<bool> PublishNext(const StepContext& context) {
  RIGCAL_ASSIGN(const auto unpublished, storage::LoadUnpublished(context.store));
  std::optional<Error> problem;
  for (const storage::RevisionKey& key : unpublished) {
    const Claim claim(context.claims, key.robot);
    if (!claim.taken()) continue;
    if (const auto folder = Publish(context.store, key, context.clock); !folder) {
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
  context.announcer.event(robot, "revision", std::to_string(revision.number), formats::WriteRevisionEvent(revision));
  RIGCAL_ASSIGN(const auto document, formats::ReadRevisionDocument(revision.document));
  context.announcer.calibration(revision, document.reference, document.solution.poses,
                                static_cast<std::int64_t>(document.edges.size()));
  return {};
}

Result<StepResult> ReviseNext(const StepContext& context) {
  StepResult result;
  RIGCAL_ASSIGN(const auto unsolved, storage::LoadUnsolvedRobots(context.store));
  for (const RobotId& robot : unsolved) {
    const Claim claim(context.claims, robot);
    if (!claim.taken()) continue;
    RIGCAL_TRY(UpdateLive(context, robot));
    RIGCAL_ASSIGN(const Burst burst, BurstOf(context, robot));
    if (burst.wake_at && (!result.wake_at || *burst.wake_at < *result.wake_at)) result.wake_at = burst.wake_at;
    if (!burst.over) continue;
    RIGCAL_TRY(ReviseAndTell(context, robot));
    result.worked = true;
    return result;
  }
  return result;
}

Result<bool> RunNextJob(const StepContext& context) {
  RIGCAL_ASSIGN(const auto job, storage::LoadNextJob(context.store, context.claims.Taken()));
  if (!job) return false;
  const Claim claim(context.claims, job->robot);
  if (!claim.taken()) return true;  // another thread was faster: look again
  RIGCAL_ASSIGN(const Edge edge, RunEdgeJob(context.store, *job, context.clock));
  RIGCAL_ASSIGN(const storage::JobCount jobs, storage::CountJobs(context.store, job->session));
  context.announcer.event(job->robot, "edge", edge.id.str(), formats::WriteEdgeEvent(edge, jobs.waiting, jobs.total));
  RIGCAL_TRY(UpdateLive(context, job->robot));
  return true;
}

}  // namespace

bool Claims::Take(const RobotId& robot) {
  const std::lock_guard lock(mutex_);
  return taken_.insert(robot).second;
}

void Claims::GiveBack(const RobotId& robot) {
  const std::lock_guard lock(mutex_);
  taken_.erase(robot);
}

std::vector<RobotId> Claims::Taken() const {
  const std::lock_guard lock(mutex_);
  return {taken_.begin(), taken_.end()};
}

Result<StepResult> Step(const StepContext& context) {
  const Result<bool> published = PublishNext(context);
  if (published && *published) return StepResult{true, std::nullopt};
  RIGCAL_ASSIGN(StepResult revised, ReviseNext(context));
  if (revised.worked) return revised;
  RIGCAL_ASSIGN(const bool ran, RunNextJob(context));
  if (ran) return StepResult{true, std::nullopt};
  if (!published) return Fail(published.error());
  return revised;
}

}  // namespace rigcal::pipeline
