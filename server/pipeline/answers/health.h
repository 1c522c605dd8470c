// Whether the server can store and answer: its threads, its database, its disk.
#pragma once

#include <filesystem>
#include <mutex>
#include <string>
#include <vector>

#include "server/base/process/vitals.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// One per server. Any thread.
class ServerHealth {
 public:
  // `folder`: of the store. Nothing is looked at yet.
  ServerHealth(std::filesystem::path folder, const Clock& clock);
  // For those who tell of further parts.
  [[nodiscard]] Vitals& vitals() { return vitals_; }

  struct Found {
    std::vector<PartState> parts;
    std::int64_t disk_free_bytes = 0;
  };
  // Looks at disk and database at most once per second, well within 5 ms; `store` is the caller's own.
  [[nodiscard]] Found Look(storage::Store& store);

 private:
  const std::filesystem::path folder_;
  Vitals vitals_;
  Part& disk_;
  Part& database_;
  std::mutex mutex_;
  Part::Time looked_at_;
  std::int64_t disk_free_bytes_ = 0;
};

}  // namespace rigcal::pipeline
