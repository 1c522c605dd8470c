// The robots that this process works on, where several processes share a store: taken from the store, renewed by a
// thread of its own as long as the process runs, given back.
#pragma once

#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "server/base/stamp.h"
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

}  // namespace rigcal::pipeline
