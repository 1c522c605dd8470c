#include "server/base/files/file_descriptor.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <system_error>

namespace rigcal {

FileDescriptor::~FileDescriptor() {
  if (fd_ >= 0) ::close(fd_);
}

bool FileDescriptor::Close() { return ::close(std::exchange(fd_, -1)) == 0; }

Result<FileDescriptor> OpenToRead(const std::filesystem::path& path) {
  // O_NONBLOCK: opening a FIFO must not hang before we can refuse it.
  FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (file.get() < 0) return FileFailure(path, "open", errno);
  struct stat info = {};
  if (::fstat(file.get(), &info) != 0) return FileFailure(path, "read", errno);
  if (!S_ISREG(info.st_mode))
    return Fail(ErrorCode::kInvalidInput, path.string() + " is not a regular file", "Give the path of a file.");
  return file;
}

std::ptrdiff_t ReadSome(const FileDescriptor& file, char* bytes, std::size_t count) {
  ssize_t got = 0;
  do {
    got = ::read(file.get(), bytes, count);
  } while (got < 0 && errno == EINTR);
  return got;
}

tl::unexpected<Error> FileFailure(const std::filesystem::path& path, std::string_view verb, int error) {
  const std::string what =
      path.string() + ": cannot " + std::string(verb) + " (" + std::generic_category().message(error) + ")";
  if (error == ENOENT || error == ENOTDIR) return Fail(ErrorCode::kNotFound, what, "Check the path.");
  if (error == EACCES || error == EPERM || error == EROFS)
    return Fail(ErrorCode::kStorage, what, "Check the permissions of the file and its folder.");
  if (error == ENOSPC || error == EDQUOT) return Fail(ErrorCode::kStorage, what, "Free space on the disk.");
  return Fail(ErrorCode::kStorage, what, "Check the disk and the system's log.");
}

}  // namespace rigcal
