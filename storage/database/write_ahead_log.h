// What lies in a log (WAL) of SQLite, by its documented format: https://sqlite.org/fileformat2.html#walformat. SQLite
// reads it up to the first frame whose checksum differs and says nothing of what is behind. For storage/ only.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace rigcal::storage {

// Fills `bytes` with those of the log at `offset`; false: they are not there, or cannot be read.
using LogReader = std::function<bool(std::int64_t offset, std::span<unsigned char> bytes)>;

// A new content of a page.
struct LogFrame {
  std::int64_t offset = 0;  // of its header; the page follows
  std::uint32_t page = 0;   // from 1
  bool ends_commit = false;
};
inline constexpr int kLogHeaderBytes = 32, kLogFrameHeaderBytes = 24;

struct LogLook {
  bool has_header = false;  // a whole one; without it SQLite reads nothing
  int page_bytes = 0;
  std::vector<LogFrame> read;    // by SQLite, up to its last commit
  std::int64_t read_bytes = 0;   // where that ends
  std::int64_t stops_at = 0;     // the byte of the first frame that is not as it was written; the end if all are
  std::vector<LogFrame> unread;  // of this lap, whole, behind that, up to their last commit
  std::int64_t unread_commits = 0;
  bool is_damaged = false;    // some of these were durable, and SQLite had gone on behind them
  bool lacks_commit = false;  // a commit is there that is not read: damaged, torn or written over
};
// Frames that an earlier lap through the file has left have other salts, and count for nothing. A checksum goes on from
// the one that is stored in the frame before: so frames are held against it behind a bad one, too.
//
// What power loss has torn is no damage: of the transaction that was under way any part may be there, its commit, which
// is its last frame, among it. But each commit is synced (synchronous = FULL) before the next frame is written. So
// where a whole commit has a whole frame behind it that goes on from its checksum, all before was durable, and a bad
// frame there was changed later. A transaction that failed and was written over may leave its commit, but nothing that
// goes on from it. Damage to the last transaction of a log looks like a torn one
// (lacks_commit).
[[nodiscard]] LogLook LookAtLog(const LogReader& read, std::int64_t bytes);

// Whether the frame whose header is at `offset`, with the content `page`, is as it was written, and goes on from the
// one before; true of pages of another size than the log's. Nobody writes to it meanwhile.
[[nodiscard]] bool IsFrameGood(const LogReader& read, std::int64_t offset, std::span<const unsigned char> page);

}  // namespace rigcal::storage
