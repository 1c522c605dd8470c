// The folder of a backup:
//   rigcal-backup        says that it is one; locked while somebody writes to it
//   blobs/ab/<digest>    contents, shared by all its databases; never taken away
//   000007/              a complete backup: rigcal.db, rigcal.db-sums and `backup`, which tells what it is
//   unfinished           there while a backup is being made: after power loss a content is what it should be only if
//   its
//                        bytes say so
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "server/base/files/file_descriptor.h"
#include "server/base/ids.h"
#include "server/base/stamp.h"

namespace rigcal::storage {

// What `backup` tells, a line each: "key value".
struct BackupLabel {
  int number = 0;
  Stamp made_at;
  std::string version;       // of rigcal
  std::string data;          // the folder that it is of
  Digest database;           // of rigcal.db
  std::int64_t blobs = 0;    // that its database names and that are there
  std::int64_t lacking = 0;  // that it names and the store had lost before
};
// What ReadLabel reads.
[[nodiscard]] std::string WriteLabel(const BackupLabel& label);
// kStorage: it is not whole. `origin` is named in the error.
[[nodiscard]] Result<BackupLabel> ReadLabel(const std::string& text, const std::string& origin);

// Where the backup of that number is, or will be.
[[nodiscard]] std::filesystem::path BackupOf(const std::filesystem::path& folder, int number);
// Those that are complete, the oldest first. kNotFound: `folder` is no backup.
[[nodiscard]] Result<std::vector<int>> ListBackups(const std::filesystem::path& folder);
[[nodiscard]] Result<BackupLabel> LoadLabel(const std::filesystem::path& folder, int number);

// A folder that this process alone may write to, until it goes.
class BackupFolder {
 public:
  // Makes it, with all its shards. kConflict: another process makes a backup there; kInvalidInput: the folder holds
  // something else.
  [[nodiscard]] static Result<BackupFolder> Open(const std::filesystem::path& folder);
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::filesystem::path blobs() const { return path_ / "blobs"; }
  // Whether the last backup into it did not come to its end; from now on nor did this one. Half-written files of before
  // are gone.
  [[nodiscard]] Result<bool> Begin();
  // An empty folder for the next backup.
  [[nodiscard]] Result<std::filesystem::path> MakeNext();
  // Everything is synced first; then that folder is the newest backup, with its label. Those before the last one go.
  [[nodiscard]] Result<BackupLabel> Finish(const std::filesystem::path& next, BackupLabel label);

 private:
  BackupFolder(std::filesystem::path path, FileDescriptor lock) : path_(std::move(path)), lock_(std::move(lock)) {}
  std::filesystem::path path_;
  FileDescriptor lock_;
};

}  // namespace rigcal::storage
