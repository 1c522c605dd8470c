#include "server/http/open_below.h"

#include <fcntl.h>
#include <linux/openat2.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>

namespace rigcal::http {
namespace {

constexpr int kToRead = O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY;

FileDescriptor OpenFolder(const std::filesystem::path& folder) {
  return FileDescriptor(folder.empty() ? -1 : ::open(folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
}

bool IsPlain(const std::filesystem::path& file) {
  const auto is_plain = [](const std::filesystem::path& part) { return !part.empty() && part != "." && part != ".."; };
  return !file.empty() && file.is_relative() && std::all_of(file.begin(), file.end(), is_plain);
}

FileDescriptor OpenStepwise(FileDescriptor at, const std::filesystem::path& file) {
  for (const std::filesystem::path& part : file.parent_path())
    at = FileDescriptor(::openat(at.get(), part.c_str(), O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  return FileDescriptor(::openat(at.get(), file.filename().c_str(), kToRead | O_NOFOLLOW));
}

}  // namespace

FileDescriptor OpenStepwiseBelow(const std::filesystem::path& folder, const std::string& file) {
  return IsPlain(file) ? OpenStepwise(OpenFolder(folder), file) : FileDescriptor(-1);
}

FileDescriptor OpenBelow(const std::filesystem::path& folder, const std::string& file) {
  if (!IsPlain(file)) return FileDescriptor(-1);
  FileDescriptor at = OpenFolder(folder);
  if (at.get() < 0) return FileDescriptor(-1);
  open_how how{};
  how.flags = kToRead;
  how.resolve = RESOLVE_BENEATH | RESOLVE_NO_SYMLINKS;
  const auto opened = ::syscall(SYS_openat2, at.get(), file.c_str(), &how, sizeof how);
  if (opened < 0 && (errno == ENOSYS || errno == EPERM)) return OpenStepwise(std::move(at), file);
  return FileDescriptor(static_cast<int>(opened));
}

}  // namespace rigcal::http
