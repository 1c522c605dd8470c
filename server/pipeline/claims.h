// Who works on a robot: one writer per robot at a time, of the threads of this process and of all processes that share its store.
#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <vector>

#include "server/base/ids.h"
#include "server/base/stamp.h"
#include "server/pipeline/robot_leases.h"

namespace rigcal::pipeline {

// Which robots are being worked on in this process. Shared by the runner's threads.
class Claims {
 public:
  [[nodiscard]] bool Take(const RobotId& robot);  // false: somebody else has it, or it rests
  // Others may take it, unless it rests.
  void GiveBack(const RobotId& robot);
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
  std::map<RobotId, Stamp> resting_;
};

// A name that is taken in this process for as long as this lives.
class Claim {
 public:
  // Takes it, if nobody else has it.
  Claim(Claims& claims, const RobotId& robot) : claims_(claims), robot_(robot), taken_(claims.Take(robot)) {}
  ~Claim() {
    if (taken_) claims_.GiveBack(robot_);
  }
  Claim(const Claim&) = delete;
  Claim& operator=(const Claim&) = delete;
  [[nodiscard]] bool taken() const { return taken_; }  // false: somebody else has it, or it rests

 private:
  Claims& claims_;
  RobotId robot_;
  bool taken_;
};

// A robot that no other process of the store works on either. `leases`: none where this process has the store for itself. What
// `store` writes meanwhile is refused if another process takes the robot over.
class RobotClaim {
 public:
  RobotClaim(Claims& claims, RobotLeases* leases, storage::Store& store, const RobotId& robot);
  ~RobotClaim();
  RobotClaim(const RobotClaim&) = delete;
  RobotClaim& operator=(const RobotClaim&) = delete;
  [[nodiscard]] bool taken() const { return claim_.taken() && (leases_ == nullptr || lease_); }

 private:
  Claim claim_;
  RobotLeases* leases_;
  storage::Store& store_;
  std::optional<storage::Lease> lease_;
  std::optional<storage::Fenced> fenced_;
};

}  // namespace rigcal::pipeline
