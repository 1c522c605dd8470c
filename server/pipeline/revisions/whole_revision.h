// READ: revisions read back: parsed once, and with every detail of their edges, which documents refer to by their ids.
#pragma once

#include <deque>
#include <memory>
#include <mutex>

#include "server/formats/documents.h"
#include "storage/store.h"

namespace rigcal::pipeline {

enum class Blocks { kLoaded, kLeftOut };

// State, diagnoses, residual and influence of an edge are what the document says: what the store has as good may be
// past in the revision. All else comes from the store, also of edges that a document of format 1 has whole, of which
// only block vectors do. Merged edges are those of that revision, without block vectors. kStorage names an edge that is
// missing.
[[nodiscard]] Result<formats::RevisionInput> LoadWholeRevision(storage::Store& store, const Revision& revision,
                                                               Blocks blocks);
// The same of its document as it was read.
[[nodiscard]] Result<formats::RevisionInput> WithWholeEdges(storage::Store& store, int number,
                                                            formats::RevisionInput document, Blocks blocks);

struct ParsedRevision {
  Revision summary;  // without the document
  std::shared_ptr<const formats::RevisionInput> document;
};

// Parsed documents by content: a query does not parse the same megabytes again. Derived from the store, may be dropped
// at any time. Shared by all threads that answer.
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
