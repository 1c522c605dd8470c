#include "server/base/files/durable_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>

#include "server/base/files/file_descriptor.h"
#include "server/base/files/move_durably.h"

namespace rigcal {
namespace {

std::filesystem::path FolderOf(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}

// Unlinks a temporary file unless it was renamed away.
class TemporaryFile {
 public:
  explicit TemporaryFile(std::filesystem::path path) : path_(std::move(path)) {}
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (!kept_) ::unlink(path_.c_str());
  }
  void Keep() { kept_ = true; }

 private:
  std::filesystem::path path_;
  bool kept_ = false;
};

// A new file beside `path`: same file system, so that rename is atomic. Sets `temporary` to its name.
FileDescriptor CreateBeside(const std::filesystem::path& path, std::filesystem::path& temporary) {
  static std::atomic<unsigned> counter{0};
  int fd = -1;
  do {
    temporary = path;
    temporary += ".tmp-" + std::to_string(::getpid()) + "-" + std::to_string(counter++);
    fd = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  } while (fd < 0 && (errno == EEXIST || errno == EINTR));
  return FileDescriptor(fd);
}

bool WriteAll(const FileDescriptor& file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file.get(), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

Status Sync(const std::filesystem::path& path, int flags) {
  const FileDescriptor file(::open(path.c_str(), flags | O_CLOEXEC));
  if (file.get() < 0) return FileFailure(path, "open", errno);
  if (::fsync(file.get()) != 0) return FileFailure(path, "sync", errno);
  return {};
}

// What a write to `path` replaces: where it is a link what that leads to, so that the link stays. A device or a pipe is
// no file to replace: rename would put a file into the place of /dev/null. Of a folder rename says so.
Result<std::filesystem::path> ReplacedBy(const std::filesystem::path& path) {
  constexpr int kLinksMax = 40;
  std::error_code failed;
  const std::filesystem::file_status status = std::filesystem::status(path, failed);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status) &&
      !std::filesystem::is_directory(status))
    return Fail(ErrorCode::kInvalidInput, path.string() + " is not a regular file", "Give the path of a file.");
  std::filesystem::path target = path;
  for (int link = 0; link < kLinksMax && std::filesystem::is_symlink(std::filesystem::symlink_status(target, failed));
       ++link)
    target = target.parent_path() / std::filesystem::read_symlink(target, failed);
  return target;
}

tl::unexpected<Error> TooLarge(const std::filesystem::path& path, std::size_t bytes_max) {
  return Fail(ErrorCode::kInvalidInput, path.string() + " is larger than " + std::to_string(bytes_max) + " bytes",
              "Check that it is the file that was meant, or make it smaller.");
}

}  // namespace

Status SyncFile(const std::filesystem::path& path) { return Sync(path, O_RDONLY); }
Status SyncFolder(const std::filesystem::path& folder) { return Sync(folder, O_RDONLY | O_DIRECTORY); }

Status MakeFolderDurably(const std::filesystem::path& folder) {
  std::error_code code;
  if (std::filesystem::is_directory(folder, code)) return {};
  const std::filesystem::path above = FolderOf(folder);
  if (above != folder) RIGCAL_TRY(MakeFolderDurably(above));
  std::filesystem::create_directory(folder, code);
  if (!code && std::filesystem::is_directory(folder, code)) return SyncFolder(above);
  return Fail(ErrorCode::kStorage,
              "cannot make the folder " + folder.string() + ": " + (code ? code.message() : "there is a file"),
              "Check that the folder above it exists and that this user may write to it.");
}

Status MoveDurably(FileDescriptor file, const std::filesystem::path& temporary, const std::filesystem::path& path) {
  if (::fsync(file.get()) != 0 || !file.Close()) return FileFailure(path, "write", errno);
  if (::rename(temporary.c_str(), path.c_str()) != 0) return FileFailure(path, "replace", errno);
  return SyncFolder(FolderOf(path));
}

Status WriteDurably(const std::filesystem::path& path, std::string_view bytes) {
  RIGCAL_ASSIGN(const std::filesystem::path replaced, ReplacedBy(path));
  std::filesystem::path temporary;
  FileDescriptor file = CreateBeside(replaced, temporary);
  if (file.get() < 0) return FileFailure(path, "create", errno);
  TemporaryFile guard(temporary);
  if (!WriteAll(file, bytes)) return FileFailure(path, "write", errno);
  RIGCAL_TRY(MoveDurably(std::move(file), temporary, replaced));
  guard.Keep();
  return {};
}

Result<std::string> ReadFile(const std::filesystem::path& path, std::size_t bytes_max) {
  RIGCAL_ASSIGN(const FileDescriptor file, OpenToRead(path));
  constexpr std::size_t kPieceBytes = 1 << 16;
  std::string bytes;
  while (true) {
    const std::size_t size = bytes.size();
    // One byte beyond the limit is asked for, so that a file of exactly the limit is told from a larger one.
    const std::size_t piece = std::min(std::max(kPieceBytes, size), bytes_max - size + (bytes_max - size < SIZE_MAX));
    bytes.resize(size + piece);
    const std::ptrdiff_t got = ReadSome(file, bytes.data() + size, piece);
    if (got < 0) return FileFailure(path, "read", errno);
    bytes.resize(size + static_cast<std::size_t>(got));
    if (bytes.size() > bytes_max) return TooLarge(path, bytes_max);
    if (got == 0) return bytes;
  }
}

}  // namespace rigcal
