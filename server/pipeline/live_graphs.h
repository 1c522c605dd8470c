// The live state of each robot: its newest edges, solved at once, provisional, without a number. Rebuilt from the
// store.
#pragma once

#include <map>
#include <mutex>
#include <optional>

#include "server/model/graph.h"

namespace rigcal::pipeline {

struct LiveGraph {
  std::int64_t watermark = 0;
  GraphSolution solution;
};

// Shared by the runner's threads.
class LiveGraphs {
 public:
  [[nodiscard]] std::optional<LiveGraph> Get(const RobotId& robot) const;
  void Set(const RobotId& robot, LiveGraph live);

 private:
  mutable std::mutex mutex_;
  std::map<RobotId, LiveGraph> graphs_;
};

}  // namespace rigcal::pipeline
