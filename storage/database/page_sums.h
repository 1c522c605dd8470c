// A sum of every page of the database, as it was last written, in a file beside it: SQLite itself does not see a byte
// that the disk has changed within a value. For storage/*.cc only.
//
// Layout of <database>-sums: 8 bytes per page in the order of the pages; all zero: not known, as the page was written
// before there were sums. In WAL mode a page of the database is written by checkpoints alone, and nobody reads one from
// it whose newer content is still in the log: so page and sum need not change at once, also where one of them is lost
// with the power, and yet each page that is read can be held against its sum.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "server/base/result.h"

namespace rigcal::storage {

inline constexpr int kPageBytes = 4096;  // SQLite's own default since 2016; other writes leave a page without a sum

// The sums of an open database: a descriptor, no other state. Any process; one thread at a time.
class PageSums {
 public:
  enum class Access { kNote, kLook };
  // To note, opens or makes the file, if there is a handle left now or when something is to be noted. Where there is no
  // file to look at, all are unknown.
  PageSums(const std::filesystem::path& database, Access access);
  ~PageSums();
  PageSums(const PageSums&) = delete;
  PageSums& operator=(const PageSums&) = delete;

  // What was written to the database at `offset`. A sum that cannot be noted forgets all of them: an old one would
  // make a good page look damaged.
  void Note(const void* bytes, int count, std::int64_t offset);
  void Truncate(std::int64_t database_bytes);
  void Sync();
  void Forget();
  // 0: not known.
  [[nodiscard]] std::uint64_t Of(std::int64_t page_idx);

 private:
  [[nodiscard]] bool IsOpen();
  void Write(std::int64_t page_idx, std::uint64_t sum);
  const std::filesystem::path file_;
  const Access access_;
  int fd_;
};

// The mark <database>-sums-log is there as long as the log (WAL) is, and is a link to it. A log that went without its
// mark, also where another one took its place, was written into the database by a program that notes no sums (`sqlite3`
// that only looked, a rigcald of before that refused the store), or was deleted: before a log is opened, such sums are
// forgotten, and the mark becomes <database>-log-went, by which that is told until somebody has read it (log_damage.h).
// Its time is that of the log's last byte.
void ForgetIfLogWent(const std::filesystem::path& database);
// After a log was opened, and before it is removed.
void MarkLog(const std::filesystem::path& database, bool is_there);
[[nodiscard]] std::filesystem::path LogMarkOf(const std::filesystem::path& database);
[[nodiscard]] std::filesystem::path WentMarkOf(const std::filesystem::path& database);

// Never 0; differs for the same bytes as another page: the first eight bytes of a SHA-256. Throws std::bad_alloc.
[[nodiscard]] std::uint64_t SumOfPage(std::int64_t page_idx, const void* bytes);
[[nodiscard]] std::filesystem::path PageSumsFile(const std::filesystem::path& database);

}  // namespace rigcal::storage
