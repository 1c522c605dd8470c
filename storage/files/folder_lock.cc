#include "storage/files/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>

#include "server/base/files/durable_file.h"
#include "server/base/files/file_descriptor.h"
#include "storage/files/folders.h"

namespace rigcal::storage {
namespace {

namespace fs = std::filesystem;

constexpr int kServersOfMachineMax = 64;

// Open until the process ends, and with it the lock.
Result<bool> LockForLife(const fs::path& path, int how) {
  FileDescriptor file(open(path.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644));
  if (file.get() < 0) return FileFailure(path, "open", errno);
  if (flock(file.get(), how | LOCK_NB) != 0) return false;
  static_cast<void>(file.Release());
  return true;
}

Status LockFolderBy(const fs::path& folder, int how) {
  const Status made = MakeFolderDurably(folder);
  const Result<bool> locked = made ? LockForLife(folder / "lock", how) : Fail(made.error());
  if (!locked)
    return Fail(ErrorCode::kStorage, "the data folder " + folder.string() + " cannot be written",
                "Give another with --data, or mend its permissions.");
  if (*locked) return {};
  return Fail(ErrorCode::kConflict, "another rigcald uses the data folder " + folder.string(),
              "Stop it, or give another folder with --data.");
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

Status LockFolder(const fs::path& folder) { return LockFolderBy(folder, LOCK_EX); }

Result<std::string> ShareFolder(const fs::path& folder, const std::string& machine) {
  RIGCAL_TRY(LockFolderBy(folder, LOCK_SH));
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
