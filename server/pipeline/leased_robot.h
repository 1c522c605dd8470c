// A robot that is worked on: by one thread of this process, and by no other process that shares its store.
#pragma once

#include <optional>

#include "server/pipeline/robot_leases.h"
#include "server/pipeline/robot_locks.h"

namespace rigcal::pipeline {

// For as long as this lives. `leases`: none where this process has the store for itself. What `store` writes meanwhile
// is refused if another process takes the robot over.
class LeasedRobot {
 public:
  LeasedRobot(RobotLocks& locks, RobotLeases* leases, storage::Store& store, const RobotId& robot);
  ~LeasedRobot();
  LeasedRobot(const LeasedRobot&) = delete;
  LeasedRobot& operator=(const LeasedRobot&) = delete;
  [[nodiscard]] bool taken() const {
    return lock_.taken() && (leases_ == nullptr || lease_);
  }  // false: somebody else has it, or it rests

 private:
  RobotLock lock_;
  RobotLeases* leases_;
  storage::Store& store_;
  std::optional<storage::Lease> lease_;
  std::optional<storage::Fenced> fenced_;
};

}  // namespace rigcal::pipeline
