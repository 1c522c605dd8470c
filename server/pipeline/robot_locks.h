// Which robots are being worked on: one writer per robot at a time, and none while a robot whose work failed rests.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <vector>

#include "server/base/ids.h"
#include "server/base/stamp.h"

namespace rigcal::pipeline {

// Shared by the runner's threads.
class RobotLocks {
 public:
  [[nodiscard]] bool Take(const RobotId& robot);  // false: somebody else has it, or it rests
  // Others may take it, unless it rests.
  void GiveBack(const RobotId& robot);
  [[nodiscard]] std::uint64_t given_back() const;    // how often one was
  [[nodiscard]] std::vector<RobotId> Taken() const;  // includes those that rest
  // Robots of which a job was begun in this round: the others come first. A round is over when one comes again.
  void Serve(const RobotId& robot);
  [[nodiscard]] std::vector<RobotId> Served() const;
  // A robot whose work failed is left alone until then, so that it holds up no other.
  void Rest(const RobotId& robot, Stamp until);
  void EndRests(Stamp now);
  [[nodiscard]] std::optional<Stamp> NextRestEnd() const;

 private:
  mutable std::mutex mutex_;
  std::set<RobotId> taken_, served_;
  std::uint64_t given_back_ = 0;
  std::map<RobotId, Stamp> resting_;
};

// A robot that is taken for as long as this lives.
class RobotLock {
 public:
  // Takes it, if nobody else has it.
  RobotLock(RobotLocks& locks, const RobotId& robot) : locks_(locks), robot_(robot), taken_(locks.Take(robot)) {}
  ~RobotLock() {
    if (taken_) locks_.GiveBack(robot_);
  }
  RobotLock(const RobotLock&) = delete;
  RobotLock& operator=(const RobotLock&) = delete;
  [[nodiscard]] bool taken() const { return taken_; }  // false: somebody else has it, or it rests

 private:
  RobotLocks& locks_;
  RobotId robot_;
  bool taken_;
};

}  // namespace rigcal::pipeline
