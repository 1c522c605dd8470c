// Parsed revision documents by content: a query does not parse the same megabytes again. Derived from the store, may be
// dropped at any time.
#pragma once

#include <deque>
#include <memory>
#include <mutex>

#include "server/formats/documents.h"
#include "storage/store.h"

namespace rigcal::pipeline {

struct ParsedRevision {
  Revision summary;  // without the document
  std::shared_ptr<const formats::RevisionInput> document;
};

// Shared by all threads that answer.
class RevisionCache {
 public:
  // The newest revision of a robot (`number` 0) or a certain one; kNotFound names the robot.
  [[nodiscard]] Result<ParsedRevision> Load(storage::Store& store, const RobotId& robot, std::int64_t number);

 private:
  struct Entry {
    Digest digest;
    std::shared_ptr<const formats::RevisionInput> document;
  };
  [[nodiscard]] std::shared_ptr<const formats::RevisionInput> Find(const Digest& digest);
  void Keep(Entry entry);

  std::mutex mutex_;
  std::deque<Entry> entries_;  // most recently used first
};

}  // namespace rigcal::pipeline
