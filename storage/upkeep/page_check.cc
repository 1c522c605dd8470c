#include "storage/upkeep/page_check.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <sqlite3.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <functional>
#include <set>
#include <thread>

#include "server/base/files/file_descriptor.h"
#include "storage/database/page_sums.h"
#include "storage/database/summing_files.h"

namespace rigcal::storage {
namespace {

namespace fs = std::filesystem;

using Page = std::array<char, kPageBytes>;

constexpr int kLooks = 10;
constexpr std::chrono::milliseconds kBetweenLooks{20};

// The bytes of a page; false where it cannot be read.
using PageReader = std::function<bool(std::int64_t page_idx, Page& bytes)>;

// By SQLite's own handle: closing another one of the same file would take its locks away.
sqlite3_file* FileOf(Connection& connection) { return FileAsItIs(connection.database().getHandle()); }

std::int64_t PagesOf(sqlite3_file* file) {
  sqlite3_int64 bytes = 0;
  return file->pMethods->xFileSize(file, &bytes) == SQLITE_OK ? bytes / kPageBytes : 0;
}

PageReader ReaderOf(sqlite3_file* file) {
  return [file](std::int64_t page_idx, Page& bytes) {
    return file->pMethods->xRead(file, bytes.data(), kPageBytes, page_idx * kPageBytes) == SQLITE_OK;
  };
}

enum class PageState { kGood, kUnknown, kOther };

PageState StateOfPage(const PageReader& read, PageSums& sums, std::int64_t page_idx) {
  const std::uint64_t sum = sums.Of(page_idx);
  if (sum == 0) return PageState::kUnknown;
  Page bytes;
  return read(page_idx, bytes) && SumOfPage(page_idx, bytes.data()) == sum ? PageState::kGood : PageState::kOther;
}

PageLook LookAt(const PageReader& read, PageSums& sums, std::int64_t pages) {
  PageLook look;
  look.pages = pages;
  for (std::int64_t page = 0; page < pages; ++page) {
    const PageState state = StateOfPage(read, sums, page);
    look.unknown += state == PageState::kUnknown ? 1 : 0;
    if (state == PageState::kOther) look.damaged.push_back(page + 1);
  }
  return look;
}

// A page and its sum do not change at once.
void LookAgain(sqlite3_file* file, PageSums& sums, std::vector<std::int64_t>& differing) {
  for (int look = 0; look < kLooks && !differing.empty(); ++look) {
    std::this_thread::sleep_for(kBetweenLooks);
    std::erase_if(differing, [&](std::int64_t page) {
      return page > PagesOf(file) || StateOfPage(ReaderOf(file), sums, page - 1) != PageState::kOther;
    });
  }
}

// A log that a process left when it died may have pages that are half written in the database: they are written anew.
void Checkpoint(Connection& connection, int mode) {
  sqlite3_wal_checkpoint_v2(connection.database().getHandle(), nullptr, mode, nullptr, nullptr);
}

Status ForEachRow(Connection& connection, const std::string& sql,
                  const std::function<void(SQLite::Statement&)>& visit) {
  return connection.Load("the database", [&]() -> Status {
    SQLite::Statement query(connection.database(), sql);
    while (query.executeStep()) visit(query);
    return {};
  });
}

Status NoteAsItIs(sqlite3_file* file, PageSums& sums, std::int64_t page_idx) {
  Page bytes;
  if (!ReaderOf(file)(page_idx, bytes))
    return Fail(ErrorCode::kStorage, "page " + std::to_string(page_idx + 1) + " of the database cannot be read",
                "Check the disk.");
  sums.Note(bytes.data(), kPageBytes, page_idx * kPageBytes);
  return {};
}

// A page of the list of free pages that is not as it was may hand out pages that rows lie in: SQLite looks whether any
// page is in two places.
bool IsStructureGood(Connection& connection) {
  std::string said;
  const Status looked = ForEachRow(connection, "PRAGMA integrity_check(1)",
                                   [&](SQLite::Statement& row) { said = row.getColumn(0).getString(); });
  return looked && said == "ok";
}

// Those that are still damaged, as they are.
Result<Mended> NoteFreePages(Connection& connection, const fs::path& database) {
  RIGCAL_ASSIGN(const PageLook still, LookAtPages(connection, database));
  const auto owners = OwnersOf(connection, still.damaged);
  const auto is_free = [](const auto& page) { return page.second.is_free; };
  Mended mended;
  mended.all_others = std::all_of(owners.begin(), owners.end(), is_free);
  mended.free_pages = std::any_of(owners.begin(), owners.end(), is_free) && IsStructureGood(connection);
  if (!mended.free_pages) return mended;
  PageSums sums(database, PageSums::Access::kNote);
  for (const auto& [page, owner] : owners)
    if (owner.is_free) RIGCAL_TRY(NoteAsItIs(FileOf(connection), sums, page - 1));
  sums.Sync();
  return mended;
}

// What a walk has not reached is free where nothing else is missing. SQLite never uses the page at a gigabyte.
bool IsAllElseFree(Connection& connection, std::int64_t reached) {
  constexpr std::int64_t kNeverUsed = 0x40000000 / kPageBytes + 1;
  std::int64_t pages = 0, free = 0;
  const Status counted = connection.Load("the database", [&]() -> Status {
    pages = connection.database().execAndGet("PRAGMA page_count").getInt64();
    free = connection.database().execAndGet("PRAGMA freelist_count").getInt64();
    return {};
  });
  return counted && reached + free + (pages >= kNeverUsed ? 1 : 0) == pages;
}

}  // namespace

Result<PageLook> LookAtPages(Connection& connection, const fs::path& database) {
  Checkpoint(connection, SQLITE_CHECKPOINT_PASSIVE);
  sqlite3_file* file = FileOf(connection);
  if (file == nullptr) return Fail(ErrorCode::kStorage, database.string() + " cannot be read", "Check the disk.");
  PageSums sums(database, PageSums::Access::kLook);
  PageLook look = LookAt(ReaderOf(file), sums, PagesOf(file));
  LookAgain(file, sums, look.damaged);
  return look;
}

Result<PageLook> LookAtPages(const fs::path& database) {
  RIGCAL_ASSIGN(const FileDescriptor file, OpenToRead(database));
  std::error_code failed;
  const auto bytes = fs::file_size(database, failed);
  const PageReader read = [&](std::int64_t page_idx, Page& page) {
    return ::pread(file.get(), page.data(), kPageBytes, page_idx * kPageBytes) == kPageBytes;
  };
  PageSums sums(database, PageSums::Access::kLook);
  return LookAt(read, sums, failed ? 0 : static_cast<std::int64_t>(bytes) / kPageBytes);
}

std::map<std::int64_t, PageOwner> OwnersOf(Connection& connection, const std::vector<std::int64_t>& pages) {
  const std::set<std::int64_t> wanted(pages.begin(), pages.end());
  std::map<std::int64_t, PageOwner> owners;
  std::int64_t reached = 0;
  const Status walked = ForEachRow(
      connection,
      "SELECT d.pageno, d.name, coalesce(s.type, '') FROM dbstat d LEFT JOIN sqlite_schema s ON s.name = d.name",
      [&](SQLite::Statement& row) {
        const std::int64_t page = row.getColumn(0).getInt64();
        ++reached;
        if (wanted.contains(page))
          owners[page] = {row.getColumn(1).getString(), row.getColumn(2).getString() == "index"};
      });
  const bool is_free = walked && IsAllElseFree(connection, reached);
  for (const std::int64_t page : pages)
    if (!owners.contains(page)) owners[page] = {{}, false, is_free};
  return owners;
}

std::string TextOfPage(std::int64_t page, const PageOwner& owner) {
  const std::string text = "page " + std::to_string(page) + " of rigcal.db";
  if (owner.is_free) return text + " (in which no row lies)";
  if (owner.name.empty()) return text;
  return text + (owner.is_index ? " (index " : " (table ") + owner.name + ")";
}

Result<Mended> MendPages(Connection& connection, const fs::path& database, const std::vector<std::int64_t>& damaged) {
  std::set<std::string> indices;
  std::set<std::int64_t> following;
  for (const auto& [page, owner] : OwnersOf(connection, damaged)) {
    if (owner.is_index) indices.insert(owner.name);
    if (owner.is_index || owner.is_free) following.insert(page);
  }
  ReadDamagedOnlyOf(connection.database().getHandle(), following);
  for (const std::string& index : indices)
    RIGCAL_TRY(connection.Write([&]() -> Status {
      connection.database().exec("REINDEX \"" + index + "\"");
      return {};
    }));
  Checkpoint(connection, SQLITE_CHECKPOINT_TRUNCATE);
  return NoteFreePages(connection, database);
}

void RefuseDamagedPages(Connection& connection) { ReadDamagedOnlyOf(connection.database().getHandle(), {}); }

Status NoteUnknownPages(Connection& connection, const fs::path& database) {
  Checkpoint(connection, SQLITE_CHECKPOINT_TRUNCATE);
  sqlite3_file* file = FileOf(connection);
  PageSums sums(database, PageSums::Access::kNote);
  for (std::int64_t page = 0; page < PagesOf(file); ++page)
    if (sums.Of(page) == 0) RIGCAL_TRY(NoteAsItIs(file, sums, page));
  sums.Sync();
  return {};
}

}  // namespace rigcal::storage
