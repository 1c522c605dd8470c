// The file system for SQLite of page_sums.h: hands everything on, and notes what is written to the database itself.
#include <sqlite3.h>

#include <cstdlib>
#include <string>
#include <string_view>

#include "server/base/process/guarded.h"
#include "storage/database/page_sums.h"

namespace rigcal::storage {
namespace {

// SQLite allocates szOsFile bytes; the file below has its own.
struct SummingFile {
  sqlite3_file base;
  sqlite3_file* below;
  PageSums* sums;  // null: not a database
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
  const int result = BelowOf(file)->xClose(Below(file));
  std::free(Below(file));
  delete SummingOf(file)->sums;
  return result;
}

int ReadBelow(sqlite3_file* file, void* bytes, int count, sqlite3_int64 offset) {
  return BelowOf(file)->xRead(Below(file), bytes, count, offset);
}

int WriteSumming(sqlite3_file* file, const void* bytes, int count, sqlite3_int64 offset) {
  const int result = BelowOf(file)->xWrite(Below(file), bytes, count, offset);
  if (result != SQLITE_OK || SummingOf(file)->sums == nullptr) return result;
  return Spared([&] { SummingOf(file)->sums->Note(bytes, count, offset); });
}

int TruncateSumming(sqlite3_file* file, sqlite3_int64 size) {
  const int result = BelowOf(file)->xTruncate(Below(file), size);
  if (result != SQLITE_OK || SummingOf(file)->sums == nullptr) return result;
  return Spared([&] { SummingOf(file)->sums->Truncate(size); });
}

// The sums first: once the database is synced, the log that could write its pages again may go.
int SyncSumming(sqlite3_file* file, int flags) {
  if (SummingOf(file)->sums != nullptr)
    if (const int summed = Spared([&] { SummingOf(file)->sums->Sync(); }); summed != SQLITE_OK) return summed;
  return BelowOf(file)->xSync(Below(file), flags);
}

int SizeBelow(sqlite3_file* file, sqlite3_int64* size) { return BelowOf(file)->xFileSize(Below(file), size); }
int LockBelow(sqlite3_file* file, int level) { return BelowOf(file)->xLock(Below(file), level); }
int UnlockBelow(sqlite3_file* file, int level) { return BelowOf(file)->xUnlock(Below(file), level); }
int CheckLockBelow(sqlite3_file* file, int* out) { return BelowOf(file)->xCheckReservedLock(Below(file), out); }
int ControlBelow(sqlite3_file* file, int what, void* argument) {
  return BelowOf(file)->xFileControl(Below(file), what, argument);
}
int SectorBelow(sqlite3_file* file) { return BelowOf(file)->xSectorSize(Below(file)); }
int TraitsBelow(sqlite3_file* file) { return BelowOf(file)->xDeviceCharacteristics(Below(file)); }
int MapBelow(sqlite3_file* file, int region, int size, int extend, void volatile** out) {
  return BelowOf(file)->xShmMap(Below(file), region, size, extend, out);
}
int ShareBelow(sqlite3_file* file, int offset, int n, int flags) {
  return BelowOf(file)->xShmLock(Below(file), offset, n, flags);
}
void BarrierBelow(sqlite3_file* file) { BelowOf(file)->xShmBarrier(Below(file)); }
int UnmapBelow(sqlite3_file* file, int remove) { return BelowOf(file)->xShmUnmap(Below(file), remove); }

// Version 2: with shared memory (WAL), without memory-mapped reading.
constexpr sqlite3_io_methods kSummingMethods = {
    2,          CloseSumming, ReadBelow,      WriteSumming, TruncateSumming, SyncSumming, SizeBelow,
    LockBelow,  UnlockBelow,  CheckLockBelow, ControlBelow, SectorBelow,     TraitsBelow, MapBelow,
    ShareBelow, BarrierBelow, UnmapBelow,     nullptr,      nullptr};

// The database whose log it is; empty: it is none.
std::string DatabaseOfLog(const char* name) {
  constexpr std::string_view kEnd = "-wal";
  const std::string_view file = name == nullptr ? "" : name;
  const bool is_log = file.size() > kEnd.size() && file.substr(file.size() - kEnd.size()) == kEnd;
  return std::string(is_log ? file.substr(0, file.size() - kEnd.size()) : "");
}

// At each call: a test may have put another one in its place.
sqlite3_vfs* FilesBelow() { return sqlite3_vfs_find(nullptr); }

int OpenSumming(sqlite3_vfs*, const char* name, sqlite3_file* file, int flags, int* out_flags) {
  sqlite3_vfs* below = FilesBelow();
  SummingFile* ours = SummingOf(file);
  ours->base.pMethods = nullptr;
  ours->sums = nullptr;
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
  if ((flags & SQLITE_OPEN_MAIN_DB) != 0 && (flags & SQLITE_OPEN_READONLY) == 0 && name != nullptr)
    ours->sums = OnceThereIsMemory([&] { return new PageSums(name, PageSums::Access::kNote); });
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

}  // namespace

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
