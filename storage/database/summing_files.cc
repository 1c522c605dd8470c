#include "storage/database/summing_files.h"

#include <sqlite3.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "server/base/process/guarded.h"
#include "storage/database/log_guard.h"
#include "storage/database/page_sums.h"
#include "storage/database/refused_pages.h"

namespace rigcal::storage {
namespace {

constexpr int kLooksAtRead = 4;
constexpr std::chrono::milliseconds kBetweenReads{10};
constexpr int kSmallestPageBytes = 512;  // SQLite reads less than that of the header only

thread_local int reading_damaged = 0;

struct SummedDatabase {
  SummedDatabase(const char* name, PageSums::Access access, bool reads_all)
      : file(name), sums(name, access), reads_damaged(reads_all) {}
  const std::filesystem::path file;
  PageSums sums;
  bool knows_log = false;              // as it has the memory that is shared with the log's other users
  bool reads_damaged;                  // any page, and from 1
  std::set<std::int64_t> damaged_too;  // or these
  LogGuard log;
  bool refuses_checkpoint = false;  // the one that has just begun
};

// SQLite allocates szOsFile bytes; the file below has its own.
struct SummingFile {
  sqlite3_file base;
  sqlite3_file* below;
  SummedDatabase* database;  // null: not a database
  SummedDatabase* logs;      // the one whose log it is; null: no log
};

SummingFile* SummingOf(sqlite3_file* file) { return reinterpret_cast<SummingFile*>(file); }
sqlite3_file* Below(sqlite3_file* file) { return SummingOf(file)->below; }
const sqlite3_io_methods* BelowOf(sqlite3_file* file) { return Below(file)->pMethods; }

// C code must not be unwound: what there was no memory for is tried again with the page.
template <typename Work>
int Spared(const Work& work) {
  const Status done = Guarded([&]() -> Status {
    work();
    return {};
  });
  return done ? SQLITE_OK : SQLITE_IOERR_NOMEM;
}

int CloseSumming(sqlite3_file* file) {
  if (SummingOf(file)->logs != nullptr) SummingOf(file)->logs->log.SetLog(nullptr);
  const int result = BelowOf(file)->xClose(Below(file));
  std::free(Below(file));
  delete SummingOf(file)->database;
  return result;
}

int ReadBelow(sqlite3_file* file, void* bytes, int count, sqlite3_int64 offset) {
  return BelowOf(file)->xRead(Below(file), bytes, count, offset);
}

bool IsRead(int result) { return result == SQLITE_OK || result == SQLITE_IOERR_SHORT_READ; }

// Of the first page SQLite learns that there is a log; whoever does not know it yet does not know either whether its
// content here is the newest, and reads it again.
bool IsHeldToSum(const SummedDatabase& database, std::int64_t page_idx) {
  return !database.reads_damaged && !database.damaged_too.contains(page_idx + 1) &&
         (database.knows_log || page_idx > 0);
}

bool IsPageGood(PageSums& sums, std::int64_t page_idx, const void* bytes) {
  const std::uint64_t sum = sums.Of(page_idx);
  return sum == 0 || SumOfPage(page_idx, bytes) == sum;
}

// What was read may be less than the page, or more: a header that was changed gives pages another size.
bool IsWholePageGood(sqlite3_file* file, std::int64_t page_idx) {
  std::array<char, kPageBytes> page{};
  return IsRead(ReadBelow(file, page.data(), kPageBytes, page_idx * kPageBytes)) &&
         IsPageGood(SummingOf(file)->database->sums, page_idx, page.data());
}

bool IsGoodNow(sqlite3_file* file, std::int64_t page_idx, void* bytes, int count, sqlite3_int64 offset) {
  return count == kPageBytes && offset % kPageBytes == 0 ? IsPageGood(SummingOf(file)->database->sums, page_idx, bytes)
                                                         : IsWholePageGood(file, page_idx);
}

// Who reads by the log's rules never sees a page between its write and that of its sum; to refuse a good one would be
// worse than to wait.
int HoldToSum(sqlite3_file* file, std::int64_t page_idx, void* bytes, int count, sqlite3_int64 offset, int result) {
  SummedDatabase& database = *SummingOf(file)->database;
  for (int look = 0; look < kLooksAtRead; ++look) {
    if (look > 0) {
      std::this_thread::sleep_for(kBetweenReads);
      result = ReadBelow(file, bytes, count, offset);
    }
    if (!IsRead(result)) return result;
    if (!IsGoodNow(file, page_idx, bytes, count, offset)) continue;
    NoteGood(database.file, page_idx + 1);
    return result;
  }
  OnceThereIsMemory([&] { NoteRefused({database.file, page_idx + 1}); });
  return SQLITE_CORRUPT;
}

void RefuseLog(const SummedDatabase& database, std::int64_t at_byte) {
  OnceThereIsMemory([&] { NoteRefused({database.file, 0, at_byte}); });
}

int ReadHoldingToLog(sqlite3_file* file, void* bytes, int count, sqlite3_int64 offset) {
  const SummedDatabase& database = *SummingOf(file)->logs;
  std::optional<std::int64_t> fault;
  for (int look = 0; look < kLooksAtRead; ++look) {
    if (look > 0) std::this_thread::sleep_for(kBetweenReads);
    const int result = ReadBelow(file, bytes, count, offset);
    if (result != SQLITE_OK || count != kPageBytes || database.reads_damaged) return result;
    fault = database.log.FaultIn({static_cast<const unsigned char*>(bytes), static_cast<std::size_t>(count)}, offset);
    if (!fault) return result;
  }
  RefuseLog(database, *fault);
  return SQLITE_CORRUPT;
}

int ReadHoldingToSums(sqlite3_file* file, void* bytes, int count, sqlite3_int64 offset) {
  if (SummingOf(file)->logs != nullptr) return ReadHoldingToLog(file, bytes, count, offset);
  int result = ReadBelow(file, bytes, count, offset);
  const SummedDatabase* database = SummingOf(file)->database;
  if (database == nullptr || !IsRead(result) || count < kSmallestPageBytes) return result;
  const int spared = Spared([&] {
    for (std::int64_t page = offset / kPageBytes; page * kPageBytes < offset + count && IsRead(result); ++page)
      if (IsHeldToSum(*database, page)) result = HoldToSum(file, page, bytes, count, offset, result);
  });
  return spared == SQLITE_OK ? result : spared;
}

// What comes behind the damage would be acknowledged, and lost with the next start.
bool IsRefusedLog(sqlite3_file* file) {
  const SummedDatabase* database = SummingOf(file)->logs;
  return database != nullptr && OnceThereIsMemory([&] { return IsLogRefused(database->file); });
}

int WriteSumming(sqlite3_file* file, const void* bytes, int count, sqlite3_int64 offset) {
  if (IsRefusedLog(file)) return SQLITE_CORRUPT;
  const int result = BelowOf(file)->xWrite(Below(file), bytes, count, offset);
  SummedDatabase* database = SummingOf(file)->database;
  if (result != SQLITE_OK || database == nullptr) return result;
  return Spared([&] {
    database->sums.Note(bytes, count, offset);
    NoteGood(database->file, offset / kPageBytes + 1);
  });
}

int TruncateSumming(sqlite3_file* file, sqlite3_int64 size) {
  const int result = BelowOf(file)->xTruncate(Below(file), size);
  if (result != SQLITE_OK || SummingOf(file)->database == nullptr) return result;
  return Spared([&] { SummingOf(file)->database->sums.Truncate(size); });
}

// The sums first: once the database is synced, the log that could write its pages again may go.
int SyncSumming(sqlite3_file* file, int flags) {
  if (SummedDatabase* database = SummingOf(file)->database; database != nullptr)
    if (const int summed = Spared([&] { database->sums.Sync(); }); summed != SQLITE_OK) return summed;
  return BelowOf(file)->xSync(Below(file), flags);
}

// A checkpoint asks for it after it has begun, and before it stores the first page.
int SizeBelow(sqlite3_file* file, sqlite3_int64* size) {
  SummedDatabase* database = SummingOf(file)->database;
  if (database != nullptr && std::exchange(database->refuses_checkpoint, false)) return SQLITE_CORRUPT;
  return BelowOf(file)->xFileSize(Below(file), size);
}
void LookBeforeCheckpoint(SummedDatabase& database) {
  const auto fault = database.log.FaultToStore();
  if (fault) RefuseLog(database, *fault);
  database.refuses_checkpoint = fault.has_value();
}
int LockBelow(sqlite3_file* file, int level) { return BelowOf(file)->xLock(Below(file), level); }
int UnlockBelow(sqlite3_file* file, int level) { return BelowOf(file)->xUnlock(Below(file), level); }
int CheckLockBelow(sqlite3_file* file, int* out) { return BelowOf(file)->xCheckReservedLock(Below(file), out); }
int ControlBelow(sqlite3_file* file, int what, void* argument) {
  SummedDatabase* database = SummingOf(file)->database;
  if (what == SQLITE_FCNTL_CKPT_START && database != nullptr) LookBeforeCheckpoint(*database);
  return BelowOf(file)->xFileControl(Below(file), what, argument);
}
int SectorBelow(sqlite3_file* file) { return BelowOf(file)->xSectorSize(Below(file)); }
int TraitsBelow(sqlite3_file* file) { return BelowOf(file)->xDeviceCharacteristics(Below(file)); }
int MapBelow(sqlite3_file* file, int region, int size, int extend, void volatile** out) {
  const int result = BelowOf(file)->xShmMap(Below(file), region, size, extend, out);
  if (SummingOf(file)->database == nullptr || result != SQLITE_OK) return result;
  SummingOf(file)->database->knows_log = true;
  if (region == 0) SummingOf(file)->database->log.SetIndex(*out);
  return result;
}
int ShareBelow(sqlite3_file* file, int offset, int n, int flags) {
  return BelowOf(file)->xShmLock(Below(file), offset, n, flags);
}
void BarrierBelow(sqlite3_file* file) { BelowOf(file)->xShmBarrier(Below(file)); }
int UnmapBelow(sqlite3_file* file, int remove) {
  if (SummingOf(file)->database != nullptr) {
    SummingOf(file)->database->knows_log = false;
    SummingOf(file)->database->log.SetIndex(nullptr);
  }
  return BelowOf(file)->xShmUnmap(Below(file), remove);
}

// Version 2: with shared memory (WAL), without memory-mapped reading.
constexpr sqlite3_io_methods kSummingMethods = {
    2,          CloseSumming, ReadHoldingToSums, WriteSumming, TruncateSumming, SyncSumming, SizeBelow,
    LockBelow,  UnlockBelow,  CheckLockBelow,    ControlBelow, SectorBelow,     TraitsBelow, MapBelow,
    ShareBelow, BarrierBelow, UnmapBelow,        nullptr,      nullptr};

// The database whose log it is; empty: it is none.
std::string DatabaseOfLog(const char* name) {
  constexpr std::string_view kEnd = "-wal";
  const std::string_view file = name == nullptr ? "" : name;
  const bool is_log = file.size() > kEnd.size() && file.substr(file.size() - kEnd.size()) == kEnd;
  return std::string(is_log ? file.substr(0, file.size() - kEnd.size()) : "");
}

// At each call: a test may have put another one in its place.
sqlite3_vfs* FilesBelow() { return sqlite3_vfs_find(nullptr); }

SummedDatabase* SummedOf(const char* name, int flags) {
  const auto access = (flags & SQLITE_OPEN_READONLY) == 0 ? PageSums::Access::kNote : PageSums::Access::kLook;
  return OnceThereIsMemory([&] { return new SummedDatabase(name, access, reading_damaged > 0); });
}

bool IsSumming(const sqlite3_file* file);

void GuardLog(SummingFile& log, sqlite3_file* database) {
  if (!IsSumming(database) || SummingOf(database)->database == nullptr) return;
  log.logs = SummingOf(database)->database;
  OnceThereIsMemory([&] {
    log.logs->log.SetLog([below = log.below](std::int64_t offset, std::span<unsigned char> bytes) {
      return below->pMethods->xRead(below, bytes.data(), static_cast<int>(bytes.size()), offset) == SQLITE_OK;
    });
  });
}

int OpenSumming(sqlite3_vfs*, const char* name, sqlite3_file* file, int flags, int* out_flags) {
  sqlite3_vfs* below = FilesBelow();
  SummingFile* ours = SummingOf(file);
  ours->base.pMethods = nullptr;
  ours->database = nullptr;
  ours->logs = nullptr;
  ours->below = static_cast<sqlite3_file*>(std::calloc(1, static_cast<std::size_t>(below->szOsFile)));
  if (ours->below == nullptr) return SQLITE_NOMEM;
  const bool is_log = (flags & SQLITE_OPEN_WAL) != 0;
  const std::string of_log = OnceThereIsMemory([&] { return is_log ? DatabaseOfLog(name) : std::string(); });
  if (!of_log.empty()) OnceThereIsMemory([&] { ForgetIfLogWent(of_log); });
  const int result = below->xOpen(below, name, ours->below, flags, out_flags);
  if (result != SQLITE_OK) {
    std::free(ours->below);
    return result;
  }
  ours->base.pMethods = &kSummingMethods;
  if (!of_log.empty()) OnceThereIsMemory([&] { MarkLog(of_log, true); });
  if (!of_log.empty()) GuardLog(*ours, sqlite3_database_file_object(name));
  if ((flags & SQLITE_OPEN_MAIN_DB) != 0 && name != nullptr) ours->database = SummedOf(name, flags);
  return SQLITE_OK;
}

// All pages of a log that is removed here have their sums.
int DeleteBelow(sqlite3_vfs*, const char* name, int sync_folder) {
  OnceThereIsMemory([&] {
    if (const std::string of_log = DatabaseOfLog(name); !of_log.empty()) MarkLog(of_log, false);
  });
  return FilesBelow()->xDelete(FilesBelow(), name, sync_folder);
}
int AccessBelow(sqlite3_vfs*, const char* name, int flags, int* out) {
  return FilesBelow()->xAccess(FilesBelow(), name, flags, out);
}
int FullNameBelow(sqlite3_vfs*, const char* name, int size, char* out) {
  return FilesBelow()->xFullPathname(FilesBelow(), name, size, out);
}

sqlite3_vfs MakeSummingFiles() {
  sqlite3_vfs files = *FilesBelow();  // what is not replaced works on no file
  files.pNext = nullptr;
  files.zName = "rigcal";
  files.szOsFile = static_cast<int>(sizeof(SummingFile));
  files.xOpen = OpenSumming;
  files.xDelete = DeleteBelow;
  files.xAccess = AccessBelow;
  files.xFullPathname = FullNameBelow;
  return files;
}

sqlite3_file* FileOfMain(sqlite3* database) {
  sqlite3_file* file = nullptr;
  sqlite3_file_control(database, "main", SQLITE_FCNTL_FILE_POINTER, &file);
  return file;
}

bool IsSumming(const sqlite3_file* file) { return file != nullptr && file->pMethods == &kSummingMethods; }

}  // namespace

ReadsDamaged::ReadsDamaged() { ++reading_damaged; }
ReadsDamaged::~ReadsDamaged() { --reading_damaged; }

void ReadDamagedOnlyOf(sqlite3* database, std::set<std::int64_t> pages) {
  sqlite3_file* file = FileOfMain(database);
  if (!IsSumming(file) || SummingOf(file)->database == nullptr) return;
  SummingOf(file)->database->reads_damaged = false;
  SummingOf(file)->database->damaged_too = std::move(pages);
  sqlite3_db_release_memory(database);
}

sqlite3_file* FileAsItIs(sqlite3* database) {
  sqlite3_file* file = FileOfMain(database);
  return IsSumming(file) ? Below(file) : file;
}

const char* SummingFiles() {
  static sqlite3_vfs files = [] {
    sqlite3_initialize();
    return MakeSummingFiles();
  }();
  static const int registered = sqlite3_vfs_register(&files, 0);
  static_cast<void>(registered);
  return files.zName;
}

}  // namespace rigcal::storage
