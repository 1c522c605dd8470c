// Complete payload files and the rows that say so: what becomes durable together.
#pragma once

#include <map>
#include <set>
#include <vector>

#include "server/base/files/cached_files.h"
#include "server/base/stamp.h"
#include "storage/files/blobs.h"
#include "storage/store.h"

namespace rigcal::dds {

struct DurableBatch {
  std::vector<storage::FinishedFile> files;
  std::map<SessionId, std::set<std::uint32_t>> held;  // payloads that become held
  std::set<SessionId> closing;                        // sessions of `held` of which they are the last
};

// Syncs the files side by side, moves them to the blob store, then records all in ONE transaction. Any thread; `store`
// and `cached`, which keeps the newest blobs in the page cache, are that thread's own. When it returns good, everything
// survives power loss; otherwise nothing is recorded.
[[nodiscard]] Status Persist(storage::Store& store, const DurableBatch& batch, CachedFiles& cached, Stamp now);

}  // namespace rigcal::dds
