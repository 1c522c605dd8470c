#include "server/base/cached_files.h"

#include <fcntl.h>

#include <system_error>

#include "server/base/file_descriptor.h"

namespace rigcal {
namespace {

void LetGo(const std::filesystem::path& path) {
  const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.get() >= 0) static_cast<void>(::posix_fadvise(file.get(), 0, 0, POSIX_FADV_DONTNEED));
}

}  // namespace

void CachedFiles::Add(const std::filesystem::path& path) {
  std::error_code unreadable;
  const auto size_bytes = static_cast<std::int64_t>(std::filesystem::file_size(path, unreadable));
  if (unreadable) return;
  files_.push_back({path, size_bytes});
  bytes_ += size_bytes;
  while (bytes_ > bytes_max_) {
    LetGo(files_.front().path);
    bytes_ -= files_.front().size_bytes;
    files_.pop_front();
  }
}

}  // namespace rigcal
