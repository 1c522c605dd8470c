#include "storage/files/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>

#include "server/base/files/durable_file.h"
#include "storage/files/folders.h"

namespace rigcal::storage {
namespace {

namespace fs = std::filesystem;

constexpr int kServersOfMachineMax = 64;

// Not open: another process has it.
Result<FileDescriptor> LockFile(const fs::path& path, int how) {
  FileDescriptor file(open(path.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644));
  if (file.get() < 0) return FileFailure(path, "open", errno);
  return flock(file.get(), how | LOCK_NB) == 0 ? std::move(file) : FileDescriptor(-1);
}

// Open until the process ends, and with it the lock.
Result<bool> LockForLife(const fs::path& path, int how) {
  RIGCAL_ASSIGN(FileDescriptor file, LockFile(path, how));
  return file.Release() >= 0;
}

Result<FileDescriptor> LockFolderBy(const fs::path& folder, int how) {
  const Status made = MakeFolderDurably(folder);
  Result<FileDescriptor> locked = made ? LockFile(folder / "lock", how) : Fail(made.error());
  if (!locked)
    return Fail(ErrorCode::kStorage, "the data folder " + folder.string() + " cannot be written",
                "Give another with --data, or mend its permissions.");
  if (locked->get() >= 0) return locked;
  return Fail(ErrorCode::kConflict, "another rigcald uses the data folder " + folder.string(),
              "Stop it, or give another folder with --data.");
}

Status LockFolderForLife(const fs::path& folder, int how) {
  RIGCAL_ASSIGN(FileDescriptor lock, LockFolderBy(folder, how));
  static_cast<void>(lock.Release());
  return {};
}

// What older versions received there, whose sessions lay side by side.
void RemoveOldIntake(const fs::path& intake) {
  constexpr std::size_t kSessionIdDigits = 64;
  std::error_code code, ignored;
  for (fs::directory_iterator entry(intake, code), end; !code && entry != end; entry.increment(code)) {
    const std::string name = entry->path().filename().string();
    if (name.size() == kSessionIdDigits && name.find_first_not_of("0123456789abcdef") == std::string::npos)
      fs::remove_all(entry->path(), ignored);
  }
}

}  // namespace

Status LockFolder(const fs::path& folder) { return LockFolderForLife(folder, LOCK_EX); }
Result<FileDescriptor> HoldFolder(const fs::path& folder) { return LockFolderBy(folder, LOCK_EX); }

bool IsFolderInUse(const fs::path& folder) {
  const FileDescriptor lock(open((folder / "lock").c_str(), O_RDWR | O_CLOEXEC));
  return lock.get() >= 0 && flock(lock.get(), LOCK_EX | LOCK_NB) != 0;
}

Result<std::string> ShareFolder(const fs::path& folder, const std::string& machine) {
  RIGCAL_TRY(LockFolderForLife(folder, LOCK_SH));
  const fs::path intake = IntakeFolderOf(folder);
  RIGCAL_TRY(MakeFolderDurably(intake));
  RemoveOldIntake(intake);
  for (int number = 1; number <= kServersOfMachineMax; ++number) {
    std::string name = machine + "-" + std::to_string(number);
    RIGCAL_ASSIGN(const bool is_mine, LockForLife(intake / (name + ".lock"), LOCK_EX));
    if (is_mine) return name;
  }
  return Fail(ErrorCode::kConflict,
              std::to_string(kServersOfMachineMax) + " rigcald of this machine use the data folder " + folder.string(),
              "Stop one of them.");
}

}  // namespace rigcal::storage
