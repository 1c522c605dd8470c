#include "storage/upkeep/backup.h"

#include <SQLiteCpp/Backup.h>
#include <SQLiteCpp/SQLiteCpp.h>
#include <sqlite3.h>

#include "server/base/files/durable_file.h"
#include "server/base/version.h"
#include "storage/database/sqlite_engine.h"
#include "storage/files/folders.h"
#include "storage/upkeep/named_blobs.h"
#include "storage/upkeep/open_unchanged.h"
#include "storage/upkeep/page_check.h"

namespace rigcal::storage {
namespace {

namespace fs = std::filesystem;

// In one step, so that it is one snapshot and need not begin again whenever somebody writes.
Status CopyDatabase(Store& store, Connection& copy) {
  return copy.Load("the copy of the database", [&]() -> Status {
    SQLite::Backup backup(copy.database(), "main", store.database(), "main");
    if (backup.executeStep(-1) == SQLITE_DONE) return {};  // nothing remains either before the first step
    return Fail(ErrorCode::kBusy, "the database was not copied whole", "Try again.");
  });
}

// Before it is copied, to name all of them: the copy would end at the first.
Status RefuseDamaged(Store& store) {
  RIGCAL_ASSIGN(const PageLook look, LookAtPages(store.connection(), DatabaseFile(store.folder())));
  if (look.damaged.empty()) return {};
  return Fail(ErrorCode::kStorage,
              "the database of " + store.folder().string() + " is damaged at page " +
                  std::to_string(look.damaged.front()) +
                  (look.damaged.size() > 1 ? " and " + std::to_string(look.damaged.size() - 1) + " more" : ""),
              "No backup was made; the last one is as it was. Run `rigcal fsck` on the data folder.");
}

Status CheckCopy(Connection& copy) {
  std::string said;
  RIGCAL_TRY(copy.Load("the copy of the database", [&]() -> Status {
    said = copy.database().execAndGet("PRAGMA quick_check(1)").getString();
    return {};
  }));
  if (said == "ok") return {};
  return Fail(ErrorCode::kStorage, "the copy of the database is damaged: " + said,
              "No backup was made; the last one is as it was. Run `rigcal fsck` on the data folder.");
}

// Named again is checked again only where somebody asked for it, or power may have been lost since it was written.
bool IsKept(const fs::path& blobs, const Digest& digest, bool checked) {
  if (!checked) return HasBlob(blobs, digest);
  const auto state = LookAtBlob(blobs, digest);
  return state && *state == BlobState::kGood;
}

struct Contents {
  const BackupOptions& options;
  const BackupFolder& folder;
  bool checked;
};

// Whether it is in the backup now.
Result<bool> Keep(const Contents& contents, const Digest& digest, BackupDone& done) {
  const fs::path blobs = contents.folder.blobs();
  if (IsKept(blobs, digest, contents.checked)) return true;
  RIGCAL_ASSIGN(const Copied copied, CopyVerified(BlobPath(BlobFolderOf(contents.options.data), digest),
                                                  BlobPath(blobs, digest), digest, contents.options.how));
  if (copied.state != BlobState::kGood) return false;
  ++done.copied;
  done.copied_bytes += copied.bytes;
  return true;
}

std::string LostText(const std::vector<NamedPayload>& payloads) {
  return TextOf(payloads) + " is in the store damaged or not at all, and in no earlier backup";
}

Status KeepAll(const Contents& contents, const NamedBlobs& named, Connection& copy, BackupDone& done) {
  std::int64_t looked_at = 0;
  for (const auto& [digest, blob] : named) {
    contents.options.progress(looked_at++, static_cast<std::int64_t>(named.size()));
    RIGCAL_ASSIGN(const bool kept, Keep(contents, digest, done));
    ++(kept ? done.label.blobs : done.label.lacking);
    if (kept || !blob.is_input) continue;
    if (blob.is_known_lost) {
      ++done.known_lost;
      continue;
    }
    RIGCAL_ASSIGN(const auto payloads, LoadPayloadsOf(copy, digest));
    done.lost.push_back(LostText(payloads));
  }
  return {};
}

Status RefuseWithin(const fs::path& data, const fs::path& folder) {
  std::error_code ignored;
  const std::string inner = fs::weakly_canonical(folder, ignored).string() + "/";
  const std::string outer = fs::weakly_canonical(data, ignored).string() + "/";
  if (inner.rfind(outer, 0) != 0) return {};
  return Fail(ErrorCode::kInvalidInput, "the backup's folder " + folder.string() + " lies in the data folder",
              "Give one elsewhere, best on another disk.");
}

Status RefuseBucket(const Store& store) {
  const Status usable = store.blobs().CheckUsable();
  if (usable) return {};
  return Fail(ErrorCode::kUnsupported, usable.error().what + ": a backup of its folder would lack most of them",
              "Have the bucket itself kept twice (versions, replication), and copy rigcal.db with `sqlite3 .backup`.");
}

// The copy is closed before its digest is taken: only then all of it is in one file.
Status Fill(const BackupOptions& options, BackupFolder& folder, Store& store, const fs::path& next, BackupDone& done) {
  RIGCAL_ASSIGN(const bool was_broken_off, folder.Begin());
  try {
    Connection copy(DatabaseFile(next), "the copy of the database");
    RIGCAL_TRY(RefuseDamaged(store));
    RIGCAL_TRY(CopyDatabase(store, copy));
    RIGCAL_TRY(CheckCopy(copy));
    RIGCAL_ASSIGN(const NamedBlobs named, LoadNamedBlobs(copy));
    return KeepAll({options, folder, options.verify || was_broken_off}, named, copy, done);
  } catch (const SQLite::Exception& failure) {
    return Fail(ErrorOf(failure, "the copy of the database in " + next.string()));
  }
}

}  // namespace

Result<BackupDone> MakeBackup(const BackupOptions& options, const Clock& clock) {
  RIGCAL_TRY(RefuseWithin(options.data, options.folder));
  RIGCAL_ASSIGN(Store store, OpenUnchanged(options.data));
  RIGCAL_TRY(RefuseBucket(store));
  RIGCAL_ASSIGN(BackupFolder folder, BackupFolder::Open(options.folder));
  RIGCAL_ASSIGN(const fs::path next, folder.MakeNext());
  BackupDone done;
  done.label.made_at = clock.Now();
  done.label.version = std::string(Version());
  done.label.data = options.data.string();
  RIGCAL_TRY(Fill(options, folder, store, next, done));
  RIGCAL_ASSIGN(done.label.database, Sha256OfFile(DatabaseFile(next)));
  RIGCAL_ASSIGN(done.label, folder.Finish(next, done.label));
  return done;
}

}  // namespace rigcal::storage
