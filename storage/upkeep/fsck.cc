#include "storage/upkeep/fsck.h"

#include <algorithm>

#include "storage/database/log_damage.h"
#include "storage/database/summing_files.h"
#include "storage/files/blobs.h"
#include "storage/files/folder_lock.h"
#include "storage/files/folders.h"
#include "storage/upkeep/open_unchanged.h"
#include "storage/upkeep/page_check.h"

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
  CheckPages(DatabaseFile(options.data), done);
  return CheckBlobFiles(BlobFolderOf(options.data), options, done);
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
  RIGCAL_TRY(RefuseNone(options.data));
  if (options.repair) RIGCAL_TRY(LockToRepair(options.data));
  FsckDone done;
  RIGCAL_ASSIGN(const bool may_open, CheckLog(options, done));
  if (!may_open) {
    RIGCAL_TRY(CheckBlobFiles(BlobFolderOf(options.data), options, done));
    return done;
  }
  Result<Store> store = OpenToLook(options.data);
  if (!store) {
    RIGCAL_TRY(CheckWithoutStore(options, store.error(), done));
    return done;
  }
  CheckPages(*store, options, done);
  if (options.repair) RefuseDamagedPages(store->connection());
  CheckRows(*store, done);
  RIGCAL_TRY(CheckFiles(*store, options, clock.Now(), done));
  if (options.repair && done.unmended() == 0) {
    RIGCAL_TRY(NoteUnknownPages(store->connection(), DatabaseFile(options.data)));
    ForgetLogThatWent(options.data);
  }
  return done;
}

}  // namespace rigcal::storage
