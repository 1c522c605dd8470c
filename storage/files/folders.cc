#include "storage/files/folders.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <system_error>
#include <vector>

#include "server/base/files/durable_file.h"
#include "storage/database/log_damage.h"
#include "storage/files/blobs.h"

namespace rigcal::storage {
namespace fs = std::filesystem;
namespace {

constexpr int kShards = 256;

// With one sync for all of them; `again`: also of those that are there, as who made them may have died before it.
Status MakeFoldersIn(const fs::path& above, const std::vector<fs::path>& folders, bool again) {
  bool made = again;
  for (const fs::path& folder : folders) {
    std::error_code code;
    made = fs::create_directory(folder, code) || made;
    if (code) return MakeFolderDurably(folder);  // which says why not
  }
  return made ? SyncFolder(above) : Status{};
}

std::vector<fs::path> ShardsOf(const fs::path& blob_folder) {
  std::vector<fs::path> shards;
  for (int shard = 0; shard < kShards; ++shard) shards.push_back(ShardFolder(blob_folder, shard));
  return shards;
}

FileDescriptor OpenFolder(const fs::path& folder) {
  return FileDescriptor(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
}

// Blobs that were being written when the last process died; nobody writes now.
void RemoveLeftovers(const fs::path& blob_folder) {
  std::error_code code;
  for (const fs::path& shard : ShardsOf(blob_folder))
    for (fs::directory_iterator entry(shard, code), end; !code && entry != end; entry.increment(code))
      if (entry->path().filename().string().find(".tmp-") != std::string::npos) fs::remove(entry->path(), code);
}

// SQLite removes the log when the last connection is closed in order.
bool WasLeftInOrder(const fs::path& folder) {
  std::error_code code;
  return !fs::exists(DatabaseFile(folder).string() + "-wal", code);
}

}  // namespace

fs::path DatabaseFile(const fs::path& folder) { return folder / "rigcal.db"; }
fs::path UnfinishedMarkOf(const fs::path& folder) { return folder / "unfinished-copy"; }
fs::path BlobFolderOf(const fs::path& folder) { return folder / "blobs"; }
fs::path IntakeFolderOf(const fs::path& folder) { return folder / "intake"; }
fs::path ReportFolderOf(const fs::path& folder) { return folder / "reports"; }

Status MakeFolders(const fs::path& folder) {
  const fs::path blob_folder = BlobFolderOf(folder);
  std::error_code code;
  const bool is_new = !fs::exists(DatabaseFile(folder), code);
  RIGCAL_TRY(MakeFolderDurably(folder));
  RIGCAL_TRY(MakeFoldersIn(folder, {blob_folder, IntakeFolderOf(folder), ReportFolderOf(folder)}, is_new));
  return MakeFoldersIn(blob_folder, ShardsOf(blob_folder), is_new);
}

FileDescriptor LockOpening(const fs::path& folder) {
  FileDescriptor lock = OpenFolder(folder);
  if (lock.get() >= 0) flock(lock.get(), LOCK_EX);
  return lock;
}

Result<FileDescriptor> MarkOpen(const fs::path& folder, bool has_log) {
  FileDescriptor mark = OpenFolder(BlobFolderOf(folder));
  if (mark.get() < 0) return FileFailure(BlobFolderOf(folder), "open", errno);
  const bool alone = flock(mark.get(), LOCK_EX | LOCK_NB) == 0;
  if (alone && has_log) RIGCAL_TRY(RefuseDamagedLog(folder));
  if (alone && !(has_log && WasLeftInOrder(folder))) {
    RemoveLeftovers(BlobFolderOf(folder));
    if (syncfs(mark.get()) != 0) return FileFailure(BlobFolderOf(folder), "sync", errno);
  }
  flock(mark.get(), LOCK_SH);
  return mark;
}

}  // namespace rigcal::storage
