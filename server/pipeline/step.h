// One piece of work, chosen from what the store says is unfinished: after a crash the same rule finds the same work.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "server/base/stamp.h"
#include "server/calib/camera/camera_memory.h"
#include "server/pipeline/reports/kept_reports.h"
#include "server/pipeline/revisions/live_graphs.h"
#include "server/pipeline/robot_leases.h"
#include "server/pipeline/robots/summaries.h"
#include "server/pipeline/workers/worker_pool.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// What is told to the world. Called from the thread that steps; must not block.
struct Announcer {
  std::function<void(const RobotId&, const std::string& kind, const std::string& subject, const std::string& json)>
      event;
  // After each new revision, whatever its verdict: what the robot was told (robot_state.h) is out of date.
  std::function<void(const RobotId&)> state;
};

struct StepContext {
  storage::Store& store;  // of the calling thread
  const Clock& clock;
  LiveGraphs& live;
  RobotLocks& locks;
  const Announcer& announcer;
  calib::CameraMemory& cameras;
  UndrawnReports* undrawn = nullptr;  // none: nobody asks why
  WorkerPool* workers = nullptr;      // none: jobs, refinements and reports are done by the calling thread
  SummaryTurn* summaries = nullptr;   // none: each step begins with the first robot
  RobotLeases* leases = nullptr;      // none: this process has the store for itself
  bool takes_jobs = true;             // false: only publishes and revises; jobs and what comes after them is for others
};

struct StepResult {
  bool worked = false;           // false: there was nothing to do
  std::optional<Stamp> wake_at;  // nothing now, but look again then (a robot that rests, or is not due yet)
};

// In this order: publish a revision; revise a robot whose burst is over (no job of it waits, or an edge has waited long
// for its revision); run one edge job, of the robots that have any in turn; judge a robot anew for which a policy of
// its fleet or rig model was set, one of its own being told to the second, or whose older visits are to be merged anew.
// What was begun before and not finished, by death of the process or a fault of ours, comes after its like, is begun
// kAttemptsMax times, and then passed over: a job as a failed edge, a report without its clouds. Last of all sessions
// are computed again that somebody asked for (recomputation/drain.h). After each, some summaries that wait are worked
// out; as long as there are more of them it has worked.
[[nodiscard]] Result<StepResult> Step(const StepContext& context);

// Robots that somebody works on, in this process or another, and those that rest.
[[nodiscard]] Result<std::vector<RobotId>> BusyRobots(const StepContext& context);
// Has an order about a robot that the calling thread has claimed carried out by one of `workers`, which there are.
[[nodiscard]] WorkerPool::Outcome RunElsewhere(const StepContext& context, const RobotId& robot,
                                               const std::string& order);

// A robot whose work failed rests until the time that this gives, so that it holds up no other; the error is logged.
[[nodiscard]] Stamp BackOff(const StepContext& context, const RobotId& robot, const Error& error);

}  // namespace rigcal::pipeline
