// The live state of each robot: its newest edges, taken in one by one, provisional, without a number. Lives as long as
// the process; the first update of a robot builds it from the store.
#pragma once

#include <map>
#include <memory>
#include <mutex>

#include "server/base/ids.h"
#include "server/graph/live/live_solver.h"
#include "server/pipeline/revisions/revise.h"

namespace rigcal::pipeline {

struct LiveGraph {
  std::int64_t watermark = -1, standing_watermark = -1;  // of the store: what it knows; -1: nothing yet
  std::unique_ptr<graph::LiveSolver> solver;
};

// Brings `live` to what the store holds: new edges are added, those that no longer count are removed. After a restart,
// for another reference, without a sensor that it holds, or where most of the graph is new, it is solved as a whole.
void TakeNewEdges(const RobotGraph& loaded, LiveGraph& live);

// Shared by the runner's threads; one robot's graph is used by the thread that has locked the robot (robot_locks.h), no
// other.
class LiveGraphs {
 public:
  // Empty at first; valid as long as this.
  [[nodiscard]] LiveGraph& Of(const RobotId& robot);

 private:
  std::mutex mutex_;
  std::map<RobotId, LiveGraph> graphs_;  // never erased: references stay good
};

}  // namespace rigcal::pipeline
