// A store becomes another one, row by row and file by file: from the one engine to the other.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "storage/store_place.h"
#include "storage/upkeep/copy_verified.h"

namespace rigcal::storage {

enum class MoveStage { kCopyingRows, kComparingRows, kCopyingFiles };

struct MoveOptions {
  StorePlace from, to;
  CopyHow how = CopyHow::kLink;  // of files
  std::function<void(MoveStage, std::int64_t done, std::int64_t total)> progress = [](MoveStage, std::int64_t,
                                                                                      std::int64_t) {};
};
struct Moved {
  bool went_on = false;    // with what a process before had copied
  bool was_there = false;  // all of it: that one was only not able to tell
  std::int64_t tables = 0, rows = 0;
  std::int64_t files = 0, copied_bytes = 0;  // bytes: of those that are no links
  std::int64_t known_lost = 0;               // files that the store had told of before
  std::vector<std::string> lost;             // inputs that the store does not have as they were, a sentence each
};

// The store at `from` stays as it is, and nobody writes to it meanwhile. Every row is in the copy, under the same key
// and cell by cell the same, and every file that rows name, held against its digest; else there is no store at `to`:
// broken off, the same again goes on. Not copied: `lease_*`, reports (drawn again), intake (sent again).
// kConflict: a server uses the store, or what is at `to` is something else; kUnsupported: the store is of another
// version than this program; kStorage: pages of it are damaged; kNotFound: there is none.
[[nodiscard]] Result<Moved> MoveStore(const MoveOptions& options);

}  // namespace rigcal::storage
