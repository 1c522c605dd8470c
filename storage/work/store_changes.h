// Tells that another process put work into the store: PostgreSQL's LISTEN. SQLite has one process, and nothing to tell.
#pragma once

#include <chrono>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "storage/store_place.h"

namespace rigcal::storage {

class PostgresLink;

// One thread at a time.
class StoreChanges {
 public:
  // Of these queues, by the names of their tables. `place` is one on PostgreSQL.
  StoreChanges(StorePlace place, std::vector<std::string> queues);
  ~StoreChanges();
  StoreChanges(const StoreChanges&) = delete;
  StoreChanges& operator=(const StoreChanges&) = delete;

  // Waits until something is put into one of them, `time` at most: into which. All of them when the connection is new,
  // for nobody knows what was missed. kStorage, at once, where there is none: the next call connects again.
  [[nodiscard]] Result<std::set<std::string>> Await(std::chrono::milliseconds time);

 private:
  void Listen();

  StorePlace place_;
  std::vector<std::string> queues_;
  std::unique_ptr<PostgresLink> link_;
};

}  // namespace rigcal::storage
