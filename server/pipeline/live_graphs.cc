#include "server/pipeline/live_graphs.h"

namespace rigcal::pipeline {

std::optional<LiveGraph> LiveGraphs::Get(const RobotId& robot) const {
  const std::lock_guard lock(mutex_);
  const auto found = graphs_.find(robot);
  return found == graphs_.end() ? std::nullopt : std::optional(found->second);
}

void LiveGraphs::Set(const RobotId& robot, LiveGraph live) {
  const std::lock_guard lock(mutex_);
  graphs_[robot] = std::move(live);
}

}  // namespace rigcal::pipeline
