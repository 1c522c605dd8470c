#include "server/pipeline/robot_locks.h"

namespace rigcal::pipeline {

bool RobotLocks::Take(const RobotId& robot) {
  const std::lock_guard lock(mutex_);
  return !resting_.contains(robot) && taken_.insert(robot).second;
}

void RobotLocks::GiveBack(const RobotId& robot) {
  const std::lock_guard lock(mutex_);
  taken_.erase(robot);
  ++given_back_;
}

std::uint64_t RobotLocks::given_back() const {
  const std::lock_guard lock(mutex_);
  return given_back_;
}

std::vector<RobotId> RobotLocks::Taken() const {
  const std::lock_guard lock(mutex_);
  std::vector<RobotId> robots(taken_.begin(), taken_.end());
  for (const auto& [robot, until] : resting_) robots.push_back(robot);
  return robots;
}

void RobotLocks::Serve(const RobotId& robot) {
  const std::lock_guard lock(mutex_);
  if (served_.insert(robot).second) return;
  served_ = {robot};
}

std::vector<RobotId> RobotLocks::Served() const {
  const std::lock_guard lock(mutex_);
  return {served_.begin(), served_.end()};
}

void RobotLocks::Rest(const RobotId& robot, Stamp until) {
  const std::lock_guard lock(mutex_);
  resting_[robot] = until;
}

std::optional<Stamp> RobotLocks::NextRestEnd() const {
  const std::lock_guard lock(mutex_);
  std::optional<Stamp> next;
  for (const auto& [robot, until] : resting_)
    if (!next || until < *next) next = until;
  return next;
}

void RobotLocks::EndRests(Stamp now) {
  const std::lock_guard lock(mutex_);
  std::erase_if(resting_, [&](const auto& rest) { return rest.second <= now; });
}

}  // namespace rigcal::pipeline
