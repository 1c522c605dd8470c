#include "storage/files/room.h"

#include <fcntl.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>

#include "server/base/files/file_descriptor.h"
#include "storage/files/folders.h"

namespace rigcal::storage {
namespace fs = std::filesystem;
namespace {

constexpr std::int64_t kReserveBytes = 4 << 20, kReserveShareBytes = 1 << 20;
constexpr std::int64_t kSpareBytes = 2 * kReserveBytes;  // what the disk must have for it
constexpr std::int64_t kLeastBytes = 1 << 20;            // with less, the log of the database hardly grows

fs::path ReserveFile(const fs::path& folder) { return folder / "reserve"; }

std::int64_t FreeBytes(const fs::path& folder) {
  struct statvfs disk = {};
  if (statvfs(folder.c_str(), &disk) != 0) return -1;
  return static_cast<std::int64_t>(disk.f_bavail) * static_cast<std::int64_t>(disk.f_frsize);
}

Error NoRoom(const fs::path& folder, const std::string& why, const char* cure) {
  return {ErrorCode::kStorage, "the disk of the data folder " + folder.string() + " cannot store anything: " + why,
          std::string(cure) + "; what is stored can still be read, and pushes go on once that is done."};
}

Error NoRoom(const fs::path& folder, int error) {
  const bool is_full = error == ENOSPC || error == EDQUOT, is_busy = error == EMFILE || error == ENFILE;
  return NoRoom(folder, std::generic_category().message(error),
                is_full   ? "Free space on it"
                : is_busy ? "Allow the server more open files (LimitNOFILE in its unit)"
                          : "Check the disk and the permissions of the folder");
}

// 0 or the errno.
int TryWriting(const fs::path& file) {
  static constexpr char kBytes[4096] = {};
  FileDescriptor probe(open(file.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0644));
  if (probe.get() < 0) return errno;
  const ssize_t written = write(probe.get(), kBytes, sizeof kBytes);
  int error = written < 0 ? errno : written < static_cast<ssize_t>(sizeof kBytes) ? ENOSPC : 0;
  if (!probe.Close() && error == 0) error = errno;
  unlink(file.c_str());
  return error;
}

}  // namespace

Result<std::int64_t> ProbeRoom(const fs::path& folder) {
  const std::int64_t free_bytes = FreeBytes(folder);
  if (free_bytes < 0) return Fail(NoRoom(folder, errno));
  const int error = TryWriting(IntakeFolderOf(folder) / ".room");
  if (error != 0) return Fail(NoRoom(folder, error));
  if (free_bytes < kLeastBytes) return Fail(NoRoom(folder, "less than 1 MiB is free", "Free space on it"));
  return free_bytes;
}

bool IsFull(const fs::path& folder) {
  const std::int64_t free_bytes = FreeBytes(folder);
  return free_bytes >= 0 && free_bytes < kLeastBytes;
}

void KeepReserve(const fs::path& folder) {
  std::error_code code;
  const auto size = fs::file_size(ReserveFile(folder), code);
  if ((!code && static_cast<std::int64_t>(size) >= kReserveBytes) || FreeBytes(folder) < kSpareBytes) return;
  const FileDescriptor file(open(ReserveFile(folder).c_str(), O_CREAT | O_WRONLY | O_CLOEXEC, 0600));
  // A file system that knows no reserving has none.
  if (file.get() >= 0) static_cast<void>(fallocate(file.get(), 0, 0, kReserveBytes));
}

bool SpendReserve(const fs::path& folder) {
  if (!IsFull(folder)) return false;
  std::error_code code;
  const auto size = static_cast<std::int64_t>(fs::file_size(ReserveFile(folder), code));
  if (code || size < kReserveShareBytes) return false;
  fs::resize_file(ReserveFile(folder), static_cast<std::uintmax_t>(size - kReserveShareBytes), code);
  return !code;
}

}  // namespace rigcal::storage
