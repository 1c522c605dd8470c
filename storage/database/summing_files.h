// The file system for SQLite under every database of ours: notes the sum of each page that is written (page_sums.h),
// and holds each page that is read against it. A page that the disk has changed is refused (SQLITE_CORRUPT, and
// refused_pages.h names it), so that it is neither served, nor written back with a sum of its own. The pages of a log
// are held to its own checksums (log_guard.h): when they are read, and all of them before a checkpoint stores the
// first. Where one is not as it was written nothing comes to that log any more. For storage/*.cc only.
#pragma once

#include <cstdint>
#include <set>

struct sqlite3;
struct sqlite3_file;

namespace rigcal::storage {

// Its name; registers it the first time. It lies over that which is the default when a file is opened. Throws nothing.
[[nodiscard]] const char* SummingFiles();

// Databases that this thread opens while one lives hand damaged pages on: to look at what is left, never to write.
class ReadsDamaged {
 public:
  ReadsDamaged();
  ~ReadsDamaged();
  ReadsDamaged(const ReadsDamaged&) = delete;
  ReadsDamaged& operator=(const ReadsDamaged&) = delete;
};
// From here on that connection hands on only these (from 1) of the damaged pages, and has none of the others in memory.
// No statement of it is under way.
void ReadDamagedOnlyOf(sqlite3* database, std::set<std::int64_t> pages);

// The file below, which hands every page on; null where there is none.
[[nodiscard]] sqlite3_file* FileAsItIs(sqlite3* database);

}  // namespace rigcal::storage
