#include "storage/upkeep/restore_backup.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fcntl.h>
#include <sys/file.h>

#include "server/base/files/durable_file.h"
#include "storage/database/query.h"
#include "storage/database/sqlite_engine.h"
#include "storage/files/folder_lock.h"
#include "storage/files/folders.h"
#include "storage/files/lost_blobs.h"
#include "storage/upkeep/copy_verified.h"
#include "storage/upkeep/named_blobs.h"
#include "storage/upkeep/page_check.h"

namespace rigcal::storage {
namespace {

namespace fs = std::filesystem;

fs::path WithoutSlash(const fs::path& path) {
  const fs::path whole = fs::absolute(path).lexically_normal();
  return whole.has_filename() ? whole : whole.parent_path();
}

Status RefuseTaken(const fs::path& data) {
  std::error_code ignored;
  if (!fs::exists(data, ignored)) return {};
  if (IsFolderInUse(data))
    return Fail(ErrorCode::kConflict, "a rigcald uses the data folder " + data.string(),
                "Stop it, and restore into a new folder.");
  if (fs::is_directory(data, ignored) && fs::is_empty(data, ignored)) return {};
  return Fail(ErrorCode::kConflict, data.string() + " is not empty",
              "Restore into a new folder, or move this one away first.");
}

Result<int> NumberToRestore(const RestoreOptions& options) {
  RIGCAL_ASSIGN(const auto numbers, ListBackups(options.folder));
  if (numbers.empty())
    return Fail(ErrorCode::kNotFound, options.folder.string() + " holds no complete backup",
                "Run `rigcal backup` again.");
  if (options.number == 0) return numbers.back();
  for (const int number : numbers)
    if (number == options.number) return number;
  return Fail(ErrorCode::kNotFound,
              options.folder.string() + " has no backup " + std::to_string(options.number) + "; its newest is " +
                  std::to_string(numbers.back()),
              "Name one that is there.");
}

// In a folder that is being filled: it is ours, and locked until it has taken its place.
constexpr const char* kMark = "restoring";

fs::path BesideOf(const fs::path& data) {
  fs::path beside = data;
  return beside += ".restoring";
}

// What a restore that was broken off has left gives way; nothing else does.
Status RemoveUnfinished(const fs::path& beside) {
  std::error_code code;
  if (!fs::exists(beside, code)) return {};
  const FileDescriptor mark(::open((beside / kMark).c_str(), O_RDWR | O_CLOEXEC));
  if (mark.get() < 0)
    return Fail(ErrorCode::kConflict, beside.string() + " is there, and no restore has left it",
                "Move it away: the backup is copied there before it takes its place.");
  if (::flock(mark.get(), LOCK_EX | LOCK_NB) != 0)
    return Fail(ErrorCode::kBusy, "another restore copies into " + beside.string(), "Wait until it has ended.");
  fs::remove_all(beside, code);
  return {};
}

// The lock of the folder that was made.
Result<FileDescriptor> MakeBeside(const fs::path& beside) {
  RIGCAL_TRY(RemoveUnfinished(beside));
  RIGCAL_TRY(MakeFolders(beside));
  FileDescriptor mark(::open((beside / kMark).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600));
  if (mark.get() < 0 || ::flock(mark.get(), LOCK_EX | LOCK_NB) != 0)
    return Fail(ErrorCode::kStorage, beside.string() + " cannot be written", "Check its permissions.");
  return mark;
}

Status CopyDatabaseFile(const fs::path& backup, const Digest& digest, const fs::path& beside) {
  RIGCAL_ASSIGN(const Copied copied, CopyVerified(DatabaseFile(backup), DatabaseFile(beside), digest, CopyHow::kCopy));
  if (copied.state != BlobState::kGood)
    return Fail(ErrorCode::kStorage, "the database of the backup " + backup.string() + " is damaged or missing",
                "Restore the backup before it with --number.");
  return {};
}

std::vector<std::string> NamesIn(Connection& database, const std::string& sql) {
  std::vector<std::string> names;
  Query query(database, sql);
  while (query.Step()) names.push_back(query.Text(0));
  return names;
}

// A backup of an older version may know no logins.
void TakeBackLogins(Connection& database, Restored& restored) {
  if (NamesIn(database, "SELECT name FROM sqlite_master WHERE type = 'table' AND name = 'login_session'").empty())
    return;
  Query(database, "DELETE FROM login_session").Run();
  restored.users = NamesIn(database, "SELECT name FROM login_password ORDER BY name");
  restored.tokens = NamesIn(database,
                            "SELECT name FROM access_token t WHERE NOT EXISTS (SELECT 1 FROM access_token_revoked "
                            "WHERE token_number = t.number) "
                            "ORDER BY name");
}

// What is lost counts as not held: whoever pushes it again sends it, and no receipt says that it is here. A backup of
// an older version may know no losses.
Status NoteLosses(Connection& database, const std::vector<std::pair<Digest, BlobState>>& lost, Restored& restored) {
  if (NamesIn(database, "SELECT name FROM sqlite_master WHERE type = 'table' AND name = 'waiting_blob'").empty())
    return {};
  restored.losses_noted = true;
  if (lost.empty()) return {};
  return database.Append("what the backup has lost", [&]() -> Status {
    for (const auto& [digest, state] : lost) NoteLost(database, digest, state, SystemClock().Now());
    return {};
  });
}

Status CopyContents(const RestoreOptions& options, const fs::path& beside, Restored& restored) {
  Connection database(DatabaseFile(beside), "the restored database");
  TakeBackLogins(database, restored);
  RIGCAL_TRY(
      NoteUnknownPages(database, DatabaseFile(beside)));  // anew: nothing says that those of the backup are whole
  RIGCAL_ASSIGN(const NamedBlobs named, LoadNamedBlobs(database));
  std::int64_t looked_at = 0;
  std::vector<std::pair<Digest, BlobState>> lost;
  for (const auto& [digest, blob] : named) {
    options.progress(looked_at++, static_cast<std::int64_t>(named.size()));
    RIGCAL_ASSIGN(const Copied copied, CopyVerified(BlobPath(options.folder / "blobs", digest),
                                                    BlobPath(BlobFolderOf(beside), digest), digest, CopyHow::kCopy));
    restored.blobs += copied.state == BlobState::kGood ? 1 : 0;
    restored.bytes += copied.bytes;
    if (copied.state == BlobState::kGood || !blob.is_input || blob.is_known_lost) continue;
    RIGCAL_ASSIGN(const auto payloads, LoadPayloadsOf(database, digest));
    restored.lost.push_back(TextOf(payloads) + " is in the backup damaged or not at all");
    lost.emplace_back(digest, copied.state);
  }
  return NoteLosses(database, lost, restored);
}

Status Fill(const RestoreOptions& options, const fs::path& beside, Restored& restored) {
  RIGCAL_TRY(CopyDatabaseFile(BackupOf(options.folder, restored.label.number), restored.label.database, beside));
  try {
    RIGCAL_TRY(CopyContents(options, beside, restored));
  } catch (const SQLite::Exception& failure) {
    return Fail(ErrorOf(failure, "the restored database"));
  }
  return SyncFileSystem(beside);
}

// An empty folder gives way.
Status TakePlace(const fs::path& beside, const fs::path& data) {
  std::error_code code;
  fs::rename(beside, data, code);
  if (code)
    return Fail(ErrorCode::kStorage, "cannot move " + beside.string() + " to " + data.string() + ": " + code.message(),
                "Move it there by hand, or restore into a folder that is not the root of a disk.");
  return SyncFolder(data.parent_path());
}

}  // namespace

Result<Restored> RestoreBackup(const RestoreOptions& options) {
  const fs::path data = WithoutSlash(options.data);
  RIGCAL_TRY(RefuseTaken(data));
  RIGCAL_ASSIGN(const int number, NumberToRestore(options));
  Restored restored;
  RIGCAL_ASSIGN(restored.label, LoadLabel(options.folder, number));
  restored.label.number = number;
  const fs::path beside = BesideOf(data);
  RIGCAL_ASSIGN(const FileDescriptor lock, MakeBeside(beside));
  RIGCAL_TRY(Fill(options, beside, restored));
  RIGCAL_TRY(TakePlace(beside, data));
  std::error_code ignored;
  fs::remove(data / kMark, ignored);
  return restored;
}

}  // namespace rigcal::storage
