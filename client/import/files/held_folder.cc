#include "client/import/files/held_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "server/base/files/durable_file.h"

namespace rigcal::importing {
namespace {

namespace fs = std::filesystem;

constexpr int kTriesMax = 100;  // who held it may remove it while it is opened here

bool IsStillAt(const fs::path& folder, const FileDescriptor& opened) {
  struct stat here {
  }, there{};
  return fstat(opened.get(), &here) == 0 && stat(folder.c_str(), &there) == 0 && here.st_ino == there.st_ino &&
         here.st_dev == there.st_dev;
}

tl::unexpected<Error> HeldElsewhere(const fs::path& folder) {
  return Fail(ErrorCode::kConflict, folder.string() + " is in use by another import or push",
              "Wait until that has ended, or give another folder.");
}

}  // namespace

Result<bool> MakeFolder(const fs::path& folder) {
  std::error_code failed;
  const bool is_new = !fs::exists(folder, failed);
  failed.clear();
  const Status made = MakeFolderDurably(folder);
  if (!made)
    fs::create_directories(folder, failed);  // one above it may not be opened: then there is no more to be done
  if (failed) return Fail(made.error());
  return is_new;
}

Result<HeldFolder> HeldFolder::Take(const fs::path& folder) {
  for (int tries = 0; tries < kTriesMax; ++tries) {
    RIGCAL_ASSIGN(const bool is_new, MakeFolder(folder));
    FileDescriptor opened(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (opened.get() < 0 && errno == ENOENT) continue;
    if (opened.get() < 0) return FileFailure(folder, "open", errno);
    if (flock(opened.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) return HeldElsewhere(folder);
    if (IsStillAt(folder, opened)) return HeldFolder(is_new ? folder : fs::path(), std::move(opened));
  }
  return HeldElsewhere(folder);
}

HeldFolder::~HeldFolder() {
  if (lock_.get() < 0 || made_.empty() || !IsStillAt(made_, lock_)) return;
  static_cast<void>(rmdir(made_.c_str()));  // fails where anything is in it
}

}  // namespace rigcal::importing
