// Which process works on a robot, where several share a store: one at a time, for some seconds that it renews as it
// works. Every take has a token of its own, and a write of whoever lost the robot meanwhile is refused (Fenced): a
// process that stalled and wakes changes nothing. Times are by the store's clock, whatever those of the machines are.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "server/base/ids.h"
#include "storage/store.h"

namespace rigcal::storage {

struct Lease {
  RobotId robot;
  std::string owner;         // the process: no other of this store has its name
  std::int64_t token = 0;    // of this robot greater than every one before
  std::string lost_by = {};  // who had it and did not give it back; empty: nobody
};

constexpr std::chrono::seconds kLeaseTime{10};

// Nothing: another owner has it, and its time is not over.
[[nodiscard]] Result<std::optional<Lease>> TakeLease(Store& store, const RobotId& robot, const std::string& owner,
                                                     std::chrono::milliseconds time = kLeaseTime);
// Also of those whose time is over and nobody else took; a no-op for those that were lost. Waits for no other writer.
[[nodiscard]] Status RenewLeases(Store& store, const std::vector<Lease>& leases,
                                 std::chrono::milliseconds time = kLeaseTime);
// Others may take it. A no-op where it was lost.
[[nodiscard]] Status GiveBackLease(Store& store, const Lease& lease);
// Robots that others have now, by name.
[[nodiscard]] Result<std::vector<RobotId>> LoadLeasedByOthers(Store& store, const std::string& owner);

// As long as this lives every Write of `store` is refused with kConflict, before its body, if somebody else took the
// robot since. The store outlives it.
class Fenced {
 public:
  Fenced(Store& store, const Lease& lease);
  ~Fenced();
  Fenced(const Fenced&) = delete;
  Fenced& operator=(const Fenced&) = delete;

 private:
  Store& store_;
};

}  // namespace rigcal::storage
