#include "storage/upkeep/fsck.h"

#include <algorithm>
#include <utility>

#include "storage/database/connection.h"
#include "storage/database/log_damage.h"
#include "storage/database/page_sums.h"
#include "storage/database/summing_files.h"
#include "storage/files/blobs.h"
#include "storage/files/folder_lock.h"
#include "storage/files/folders.h"
#include "storage/upkeep/open_unchanged.h"
#include "storage/upkeep/page_check.h"
#include "storage/work/servers.h"

namespace rigcal::storage {
namespace {

namespace fs = std::filesystem;

// Before the folder is locked: that would make it.
Status RefuseNone(const fs::path& folder) {
  std::error_code ignored;
  if (fs::is_regular_file(DatabaseFile(folder), ignored)) return {};
  return Fail(ErrorCode::kNotFound, folder.string() + " holds no store: there is no rigcal.db",
              "Give the folder that `rigcald --data` has.");
}

Status LockToRepair(const fs::path& folder) {
  const Status locked = LockFolder(folder);
  if (locked || locked.error().code != ErrorCode::kConflict) return locked;
  return Fail(ErrorCode::kConflict, "a rigcald uses the data folder " + folder.string(),
              "Stop it to repair; without --repair it may serve meanwhile.");
}

Result<Store> OpenToLook(const fs::path& folder) {
  const ReadsDamaged looking;
  return OpenUnchanged(folder);
}

void AddError(const Error& error, FsckDone& done) {
  done.findings.push_back({Finding::Kind::kRow, error.what, error.cure});
}

// SQLite does not get as far as the first row.
Status CheckWithoutStore(const FsckOptions& options, const Error& why, FsckDone& done) {
  if (why.code != ErrorCode::kStorage && why.code != ErrorCode::kConflict) return Fail(why);
  AddError(why, done);
  CheckPages(DatabaseFile(options.place.folder), done);
  return CheckBlobFiles(BlobFolderOf(options.place.folder), options, done);
}

// A damaged database may not name its contents: each file still tells by its own name what it should be.
Status CheckFiles(Store& store, const FsckOptions& options, Stamp now, FsckDone& done) {
  if (const Status usable = store.blobs().CheckUsable(); !usable) {
    done.findings.push_back({Finding::Kind::kInput, usable.error().what + ": they were not looked at",
                             "Nothing is to be done: each is held against its digest when it is read.", false});
    return {};
  }
  if (const Status named = CheckBlobs(store, options, now, done); !named) {
    AddError(named.error(), done);
    return CheckBlobFiles(store.BlobFolder(), options, done);
  }
  if (const Status looked = CheckReports(store, options, done); !looked) AddError(looked.error(), done);
  if (const Status looked = CheckOrphans(store, options, now, done); !looked) AddError(looked.error(), done);
  return {};
}

bool HasSums(const fs::path& folder) {
  std::error_code ignored;
  return fs::exists(PageSumsFile(DatabaseFile(folder)), ignored);
}

// Whoever opens a store makes the file, and empties it where it holds no longer: nobody removes it.
Finding SumsGone(bool are_made_anew) {
  return {
      Finding::Kind::kPage,
      "rigcal.db-sums is gone: what the disk, or another program, has changed within a value of rigcal.db cannot be "
      "told",
      "If you removed it, or copied rigcal.db alone, `rigcal fsck --repair` makes new sums of the pages as they "
      "are; else restore the newest backup (`rigcal restore-backup`).",
      true, are_made_anew};
}

Finding SumsMade(std::int64_t pages) {
  return {Finding::Kind::kPage, std::to_string(pages) + " pages of rigcal.db had no sum, and have one now as they are",
          "What was changed within their values before cannot be told any more.", false, true};
}

// Only where all that can be looked at is good.
Status MakeSums(Store& store, bool had_sums, const FsckOptions& options, FsckDone& done) {
  const bool makes = options.repair && done.unmended() == 0;
  if (makes) RIGCAL_TRY(NoteUnknownPages(store.connection(), DatabaseFile(options.place.folder)));
  if (makes && done.pages_unknown > 0) done.findings.push_back(SumsMade(std::exchange(done.pages_unknown, 0)));
  if (!had_sums) done.findings.push_back(SumsGone(makes));
  return {};
}

// Other machines may work on a store in PostgreSQL, with a folder that they share or one of their own.
Status RefuseAtWork(Store& store) {
  return store.connection().Load("the store at " + NameOf(store.place()), [&]() -> Status {
    if (!IsAtWork(store.connection())) return {};
    return Fail(ErrorCode::kConflict, "a rigcald or a rigcal-worker uses the store at " + NameOf(store.place()),
                "Stop them to repair, and wait 15 s where one was killed; without --repair they may serve meanwhile.");
  });
}

Result<FsckDone> FsckOnServer(const FsckOptions& options, const Clock& clock) {
  RIGCAL_ASSIGN(Store store, OpenUnchanged(options.place));
  if (options.repair) {
    RIGCAL_TRY(LockToRepair(options.place.folder));
    RIGCAL_TRY(RefuseAtWork(store));
  }
  FsckDone done;
  CheckRows(store, done);
  RIGCAL_TRY(CheckFiles(store, options, clock.Now(), done));
  return done;
}

}  // namespace

std::string NameOf(Finding::Kind kind) {
  constexpr const char* kNames[] = {"log", "page", "row", "input", "derived", "report", "orphan", "aside"};
  return kNames[static_cast<std::size_t>(kind)];
}

std::int64_t FsckDone::unmended() const {
  return std::count_if(findings.begin(), findings.end(),
                       [](const Finding& one) { return one.is_damage && !one.is_mended && !one.is_lost; });
}

std::int64_t FsckDone::lost() const {
  return std::count_if(findings.begin(), findings.end(), [](const Finding& one) { return one.is_lost; });
}

Result<FsckDone> Fsck(const FsckOptions& options, const Clock& clock) {
  if (!options.place.server.empty()) return FsckOnServer(options, clock);
  RIGCAL_TRY(RefuseNone(options.place.folder));
  if (options.repair) RIGCAL_TRY(LockToRepair(options.place.folder));
  const bool had_sums = HasSums(options.place.folder);  // opening makes them
  FsckDone done;
  RIGCAL_ASSIGN(const bool may_open, CheckLog(options, done));
  if (!may_open) {
    RIGCAL_TRY(CheckBlobFiles(BlobFolderOf(options.place.folder), options, done));
    return done;
  }
  Result<Store> store = OpenToLook(options.place.folder);
  if (!store) {
    RIGCAL_TRY(CheckWithoutStore(options, store.error(), done));
    return done;
  }
  CheckPages(*store, options, done);
  if (options.repair) RefuseDamagedPages(store->connection());
  CheckRows(*store, done);
  RIGCAL_TRY(CheckFiles(*store, options, clock.Now(), done));
  RIGCAL_TRY(MakeSums(*store, had_sums, options, done));
  if (options.repair && done.unmended() == 0) ForgetLogThatWent(options.place.folder);
  return done;
}

}  // namespace rigcal::storage
