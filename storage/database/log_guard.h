// The log (WAL) of an open database, held to its checksums each time a page of it is read or is about to be stored:
// SQLite itself finds frames by its index (-shm), in which memory vouches for what lies on the disk. For
// storage/database/*.cc only.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "storage/database/write_ahead_log.h"

namespace rigcal::storage {

// Of one connection; its thread only.
class LogGuard {
 public:
  // The first region of the index as it is mapped; null: it is not any more.
  void SetIndex(const volatile void* region) { index_ = static_cast<const volatile std::uint32_t*>(region); }
  // Reads the open log; null: it is closed.
  void SetLog(LogReader read) { read_ = std::move(read); }

  // Whether the bytes at that place of the log are a page of a frame that is committed and not as it was written: then
  // the byte where the frame begins. What cannot be read is no damage: SQLite's own read of it says so. What is under
  // way in a transaction SQLite may still write over, sums and all.
  [[nodiscard]] std::optional<std::int64_t> FaultIn(std::span<const unsigned char> bytes, std::int64_t offset) const;
  // The same of all frames that are committed and not yet in the database.
  [[nodiscard]] std::optional<std::int64_t> FaultToStore() const;

 private:
  // Frames, from 1; 0: not known.
  [[nodiscard]] std::int64_t Committed() const;
  [[nodiscard]] std::int64_t Stored() const;

  const volatile std::uint32_t* index_ = nullptr;
  LogReader read_;
};

}  // namespace rigcal::storage
