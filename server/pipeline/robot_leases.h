// The robots that this process works on, where several processes share a store: taken from the store, renewed by a
// thread of its own as long as the process runs, given back.
#pragma once

#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "server/base/stamp.h"
#include "server/pipeline/robot_locks.h"
#include "storage/work/leases.h"

namespace rigcal::pipeline {

class RobotLeases {
 public:
  // `owner`: no other process of the store has this name. Errors are the store's.
  [[nodiscard]] static Result<std::unique_ptr<RobotLeases>> Start(const storage::StorePlace& place, const Clock& clock,
                                                                  std::string owner);
  ~RobotLeases();
  RobotLeases(const RobotLeases&) = delete;
  RobotLeases& operator=(const RobotLeases&) = delete;

  // Nothing: another process has it, or the store cannot say (then the log does). What was left open by one that lost
  // it is closed.
  [[nodiscard]] std::optional<storage::Lease> Take(storage::Store& store, const RobotId& robot);
  void GiveBack(storage::Store& store, const storage::Lease& lease);
  // That of a robot that this process has; nothing: it has not.
  [[nodiscard]] std::optional<storage::Lease> HeldOf(const RobotId& robot) const;
  [[nodiscard]] const std::string& owner() const { return owner_; }

 private:
  RobotLeases(storage::Store store, const Clock& clock, std::string owner);
  void Renew();

  storage::Store store_;  // of the thread that renews
  const Clock& clock_;
  const std::string owner_;
  mutable std::mutex mutex_;
  std::condition_variable stop_;
  bool stopping_ = false;                   // guarded by mutex_
  std::map<RobotId, storage::Lease> held_;  // likewise
  std::thread thread_;
};

// A robot that is worked on, by one thread of this process and by no other process that shares its store, for as long
// as this lives. `leases`: none where this process has the store for itself. What `store` writes meanwhile
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
