#include "storage/files/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>

#include "server/base/files/durable_file.h"

namespace rigcal::storage {

Status LockFolder(const std::filesystem::path& folder) {
  const Status made = MakeFolderDurably(folder);
  const int file = open((folder / "lock").c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644);
  if (!made || file < 0)
    return Fail(ErrorCode::kStorage, "the data folder " + folder.string() + " cannot be written",
                "Give another with --data, or mend its permissions.");
  if (flock(file, LOCK_EX | LOCK_NB) == 0) return {};
  return Fail(ErrorCode::kConflict, "another rigcald uses the data folder " + folder.string(),
              "Stop it, or give another folder with --data.");
}

}  // namespace rigcal::storage
