#include "storage/upkeep/backup_folder.h"

#include <fcntl.h>
#include <sys/file.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <sstream>

#include "server/base/files/durable_file.h"
#include "storage/files/blobs.h"
#include "storage/upkeep/copy_verified.h"
#include "storage/upkeep/named_blobs.h"

namespace rigcal::storage {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMark = "rigcal-backup";
constexpr const char* kUnfinished = "unfinished";
constexpr const char* kNext = "next";
constexpr const char* kLabel = "backup";
constexpr std::size_t kLabelBytesMax = 1 << 16;
constexpr std::size_t kKept = 2;

Error CannotWrite(const fs::path& path, const std::error_code& code) {
  return {ErrorCode::kStorage, path.string() + " cannot be written: " + code.message(),
          "Check the free space and the permissions of the backup's folder."};
}

// 0: not the name of one.
int NumberOf(const fs::path& folder) {
  const std::string name = folder.filename().string();
  const bool is_number =
      name.size() >= 6 && name.size() <= 9 && name.find_first_not_of("0123456789") == std::string::npos;
  return is_number ? std::stoi(name) : 0;
}

bool IsOurs(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_regular_file(folder / kMark, ignored) || fs::is_empty(folder, ignored);
}

Status MakeBlobFolders(const fs::path& blobs) {
  std::error_code code;
  for (int shard = 0; shard < 256; ++shard) {
    fs::create_directories(ShardFolder(blobs, shard), code);
    if (code) return Fail(CannotWrite(ShardFolder(blobs, shard), code));
  }
  return {};
}

}  // namespace

std::string WriteLabel(const BackupLabel& label) {
  std::ostringstream text;
  text << "format 1\nnumber " << label.number << "\nmade_at " << ToIso(label.made_at) << "\nversion " << label.version
       << "\ndata " << label.data << "\ndatabase " << label.database.str() << "\nblobs " << label.blobs << "\nlacking "
       << label.lacking << "\n";
  return text.str();
}

Result<BackupLabel> ReadLabel(const std::string& text, const std::string& origin) {
  std::map<std::string, std::string> values;
  std::istringstream lines(text);
  for (std::string key, value; lines >> key && std::getline(lines >> std::ws, value);) values[key] = value;
  const auto made_at = ParseIso(values["made_at"]);
  BackupLabel label;
  const bool is_whole = values["format"] == "1" && made_at && CheckDigest("sha256", values["database"]) &&
                        std::sscanf(values["number"].c_str(), "%d", &label.number) == 1 &&
                        std::sscanf(values["blobs"].c_str(), "%ld", &label.blobs) == 1 &&
                        std::sscanf(values["lacking"].c_str(), "%ld", &label.lacking) == 1;
  if (!is_whole)
    return Fail(ErrorCode::kStorage, origin + " does not tell of a whole backup",
                "Restore the backup before it with --number.");
  label.made_at = *made_at;
  label.version = values["version"];
  label.data = values["data"];
  label.database = Digest(values["database"]);
  return label;
}

fs::path BackupOf(const fs::path& folder, int number) {
  std::array<char, 16> name{};
  std::snprintf(name.data(), name.size(), "%06d", number);
  return folder / name.data();
}

Result<std::vector<int>> ListBackups(const fs::path& folder) {
  std::error_code code;
  if (!fs::is_regular_file(folder / kMark, code))
    return Fail(ErrorCode::kNotFound, folder.string() + " is no backup", "Give the folder that `rigcal backup` made.");
  std::vector<int> numbers;
  for (fs::directory_iterator entry(folder, code), end; !code && entry != end; entry.increment(code))
    if (NumberOf(entry->path()) > 0) numbers.push_back(NumberOf(entry->path()));
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

Result<BackupLabel> LoadLabel(const fs::path& folder, int number) {
  const fs::path file = BackupOf(folder, number) / kLabel;
  RIGCAL_ASSIGN(const std::string text, ReadFile(file, kLabelBytesMax));
  return ReadLabel(text, file.string());
}

Result<BackupFolder> BackupFolder::Open(const fs::path& folder) {
  std::error_code code;
  fs::create_directories(folder, code);
  if (code) return Fail(CannotWrite(folder, code));
  if (!IsOurs(folder))
    return Fail(ErrorCode::kInvalidInput, folder.string() + " holds something that is no backup",
                "Give an empty or a new folder, or that of an earlier backup.");
  FileDescriptor mark(::open((folder / kMark).c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644));
  if (mark.get() < 0) return FileFailure(folder / kMark, "create", errno);
  if (::flock(mark.get(), LOCK_EX | LOCK_NB) != 0)
    return Fail(ErrorCode::kConflict, "another backup into " + folder.string() + " is under way",
                "Wait until it is done.");
  RIGCAL_TRY(MakeBlobFolders(folder / "blobs"));
  return BackupFolder(folder, std::move(mark));
}

Result<bool> BackupFolder::Begin() {
  std::error_code ignored;
  const bool was_broken_off = fs::exists(path_ / kUnfinished, ignored);
  if (!was_broken_off) RIGCAL_TRY(WriteDurably(path_ / kUnfinished, ""));
  RIGCAL_TRY(ForEachBlobFile(blobs(), [](const fs::directory_entry& entry, BlobFileKind kind) {
    std::error_code failed;
    if (kind == BlobFileKind::kHalf) fs::remove(entry.path(), failed);
  }));
  return was_broken_off;
}

Result<fs::path> BackupFolder::MakeNext() {
  std::error_code code;
  const fs::path next = path_ / kNext;
  fs::remove_all(next, code);
  if (!code) fs::create_directory(next, code);
  if (code) return Fail(CannotWrite(next, code));
  return next;
}

Result<BackupLabel> BackupFolder::Finish(const fs::path& next, BackupLabel label) {
  RIGCAL_ASSIGN(const auto before, ListBackups(path_));
  label.number = before.empty() ? 1 : before.back() + 1;
  RIGCAL_TRY(WriteDurably(next / kLabel, WriteLabel(label)));
  RIGCAL_TRY(SyncFileSystem(path_));
  std::error_code code;
  fs::rename(next, BackupOf(path_, label.number), code);
  if (code) return Fail(CannotWrite(next, code));
  fs::remove(path_ / kUnfinished, code);
  RIGCAL_TRY(SyncFolder(path_));
  for (std::size_t i = 0; i + kKept <= before.size(); ++i) fs::remove_all(BackupOf(path_, before[i]), code);
  return label;
}

}  // namespace rigcal::storage
