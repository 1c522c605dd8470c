// Thread T: tells who reads of a robot what is stored of it, when somebody begins to read and when there is a new
// revision. It has a store of its own, so that loading a fleet's states, once it comes back all at once, holds up no
// receipt.
#pragma once

#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <utility>

#include "server/base/process/vitals.h"
#include "server/dds/tell/outbox.h"

namespace rigcal::dds {

class Teller {
 public:
  // Outbox, callbacks and part outlive it.
  Teller(storage::Store store, Outbox& outbox, const Callbacks& callbacks, Part& part)
      : store_(std::move(store)), outbox_(outbox), callbacks_(callbacks), part_(part) {}
  void Run();   // until Stop
  void Stop();  // any thread; so may the next two be called, which never block

  // Somebody began to read of the robot. In turn.
  void TellSoon(const RobotId& robot) { Put(robot, std::chrono::steady_clock::now()); }
  // There is a new revision of it, which is stored. Before all that are told in turn.
  void TellNext(const RobotId& robot) { Put(robot, Time()); }

 private:
  using Time = std::chrono::steady_clock::time_point;
  struct Waiting {
    std::map<RobotId, Time> due;
    std::set<std::pair<Time, RobotId>> order;  // the same, by time
    bool stopped = false;
  };
  void Put(const RobotId& robot, Time due);
  [[nodiscard]] std::optional<RobotId> Next();  // waits for one that is due; nothing: stopped
  [[nodiscard]] Status Tell(const RobotId& robot);
  // While any robot is not told the part has a problem, however well others are.
  void TellOrRetry(const RobotId& robot);

  storage::Store store_;
  Outbox& outbox_;
  const Callbacks& callbacks_;
  Part& part_;
  std::map<RobotId, std::chrono::seconds> failing_;  // of thread T: after how long each is tried again; it was logged
  std::mutex mutex_;
  std::condition_variable changed_;
  Waiting waiting_;  // guarded by mutex_
};

}  // namespace rigcal::dds
