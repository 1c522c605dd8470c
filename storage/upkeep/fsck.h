// Whether a store is what was stored: every page, row, reference and content; and what can be mended of it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "server/base/stamp.h"
#include "storage/store.h"

namespace rigcal::storage {

// What was found: one sentence, and one of what to do.
struct Finding {
  enum class Kind {
    kLog,      // of the database: SQLite's -wal
    kPage,     // of the database; of PostgreSQL, whether it holds its own pages to sums
    kRow,      // or what SQLite says of its structure
    kInput,    // a content that robots pushed
    kDerived,  // a content that is made again of inputs
    kReport,   // a report that is drawn again
    kOrphan,   // files that no row names, together
    kAside,    // damaged files that were set aside before, together
  };
  Kind kind = Kind::kRow;
  std::string what, cure;
  bool is_damage = true;   // else it is only told
  bool is_mended = false;  // or marked, so that the server makes it again
  bool is_lost = false;    // nobody here can mend it: the server takes it again when it is pushed
};
// "log", "page", "row", "input", "derived", "report", "orphan", "aside"
[[nodiscard]] std::string NameOf(Finding::Kind kind);

struct FsckOptions {
  StorePlace place;
  bool repair = false;  // nobody else may have the store
  std::function<void(std::int64_t done, std::int64_t total)> progress = [](std::int64_t, std::int64_t) {};  // contents
};
struct FsckDone {
  std::vector<Finding> findings;
  std::int64_t pages = 0;
  std::int64_t pages_unknown = 0;          // only SQLite's own checks speak for them; 0 once `repair` noted them
  std::int64_t blobs = 0, blob_bytes = 0;  // contents that rows name and that are good
  // Damage that is still there and about which something is to be done here.
  [[nodiscard]] std::int64_t unmended() const;
  // Contents that are lost until they are pushed again.
  [[nodiscard]] std::int64_t lost() const;
};

// Without `repair` nothing is changed, and a rigcald may serve the store meanwhile. With it damaged contents are set
// aside (never deleted): an input then counts as not held, so that pushing its session sends it again; what derives is
// queued to be made again; indices are built anew; orphans older than a day are removed, where nothing else is damaged.
// kConflict: a rigcald uses the store, and `repair` was asked for. The error is of a store that cannot be looked at.
// Of a store in PostgreSQL pages and indices are that server's own to check; all else is done alike.
[[nodiscard]] Result<FsckDone> Fsck(const FsckOptions& options, const Clock& clock);

// Parts of it, in the order in which they are done: each adds its findings.
// Before the database is opened. False: it must not be, as that would take away what is still there.
[[nodiscard]] Result<bool> CheckLog(const FsckOptions& options, FsckDone& done);
// Of this folder, commits were lost and are not known to have been pushed again: they may have named any file.
[[nodiscard]] bool HasLostCommits(const std::filesystem::path& data);
void CheckPages(Store& store, const FsckOptions& options, FsckDone& done);
// Of a database that cannot be opened.
void CheckPages(const std::filesystem::path& database, FsckDone& done);
void CheckRows(Store& store, FsckDone& done);
// Of a store in PostgreSQL: whether that holds its pages to sums, and every reference between rows.
void CheckServer(Store& store, FsckDone& done);
[[nodiscard]] Status CheckBlobs(Store& store, const FsckOptions& options, Stamp now, FsckDone& done);
// By the names of the files alone, where the database cannot tell which there should be.
[[nodiscard]] Status CheckBlobFiles(const std::filesystem::path& blob_folder, const FsckOptions& options,
                                    FsckDone& done);
[[nodiscard]] Status CheckReports(Store& store, const FsckOptions& options, FsckDone& done);
[[nodiscard]] Status CheckOrphans(Store& store, const FsckOptions& options, Stamp now, FsckDone& done);

}  // namespace rigcal::storage
