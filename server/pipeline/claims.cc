#include "server/pipeline/claims.h"

namespace rigcal::pipeline {

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

void Claims::Serve(const RobotId& robot) {
  const std::lock_guard lock(mutex_);
  if (served_.insert(robot).second) return;
  served_ = {robot};
}

std::vector<RobotId> Claims::Served() const {
  const std::lock_guard lock(mutex_);
  return {served_.begin(), served_.end()};
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

RobotClaim::RobotClaim(Claims& claims, RobotLeases* leases, storage::Store& store, const RobotId& robot)
    : claim_(claims, robot), leases_(leases), store_(store) {
  if (leases_ == nullptr || !claim_.taken()) return;
  lease_ = leases_->Take(store, robot);
  if (lease_) fenced_.emplace(store, *lease_);
}

RobotClaim::~RobotClaim() {
  fenced_.reset();
  if (lease_) leases_->GiveBack(store_, *lease_);
}

}  // namespace rigcal::pipeline
