#include "server/pipeline/leased_robot.h"

namespace rigcal::pipeline {

LeasedRobot::LeasedRobot(RobotLocks& locks, RobotLeases* leases, storage::Store& store, const RobotId& robot)
    : lock_(locks, robot), leases_(leases), store_(store) {
  if (leases_ == nullptr || !lock_.taken()) return;
  lease_ = leases_->Take(store, robot);
  if (lease_) fenced_.emplace(store, *lease_);
}

LeasedRobot::~LeasedRobot() {
  fenced_.reset();
  if (lease_) leases_->GiveBack(store_, *lease_);
}

}  // namespace rigcal::pipeline
