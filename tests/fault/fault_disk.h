// A disk for SQLite that fails at a chosen operation: a wrapper around SQLite's own file system, the default one while
// a FaultDisk lives. One at a time; not for several threads.
#pragma once

#include <sqlite3.h>

#include <map>
#include <string>

namespace rigcal::fault {

enum class Fault {
  kOnce,       // one operation fails: a bad sector
  kFromThere,  // it and all that follow: the disk is full or gone; what was written stays
  kPowerLoss,  // likewise, and then each file is as it was at its last sync: nothing else reached the disk
};

class FaultDisk {
 public:
  FaultDisk();
  ~FaultDisk();
  FaultDisk(const FaultDisk&) = delete;
  FaultDisk& operator=(const FaultDisk&) = delete;

  // Counts writes, syncs, truncations and deletions from now on; number `at` (from 1) fails, a write after half its
  // bytes.
  void Arm(Fault fault, int at);
  // Operations work again. After kPowerLoss: call it when all connections are closed.
  void Repair();
  [[nodiscard]] bool failed() const { return failed_; }

  // For the wrapper.
  [[nodiscard]] bool FailsNow();
  void OnOpen(const std::string& path);
  void OnSync(const std::string& path);
  void OnDelete(const std::string& path);
  [[nodiscard]] sqlite3_vfs* real() const { return real_; }

 private:
  sqlite3_vfs* real_ = nullptr;
  sqlite3_vfs wrapper_{};
  Fault fault_ = Fault::kOnce;
  int at_ = 0;  // 0: not armed
  int count_ = 0;
  bool failed_ = false;
  std::map<std::string, std::string> synced_;  // content at the last sync, by path
};

}  // namespace rigcal::fault
