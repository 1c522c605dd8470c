#include "server/base/files/cached_files.h"

#include <fcntl.h>

#include <algorithm>
#include <system_error>

#include "server/base/files/file_descriptor.h"

namespace rigcal {
namespace {

void LetGo(const std::filesystem::path& path) {
  const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (file.get() >= 0) static_cast<void>(::posix_fadvise(file.get(), 0, 0, POSIX_FADV_DONTNEED));
}

// Of the page cache: whole pages, and at least one, so that the list is short however small the files.
std::int64_t CachedBytes(std::uintmax_t size_bytes) {
  constexpr std::uintmax_t kPageBytes = 4096;
  return static_cast<std::int64_t>((std::max<std::uintmax_t>(size_bytes, 1) + kPageBytes - 1) / kPageBytes *
                                   kPageBytes);
}

}  // namespace

void CachedFiles::Add(const std::filesystem::path& path) {
  std::error_code unreadable;
  const std::uintmax_t size_bytes = std::filesystem::file_size(path, unreadable);
  if (unreadable) return;
  files_.push_back({path, CachedBytes(size_bytes)});
  bytes_ += files_.back().bytes;
  while (bytes_ > bytes_max_) {
    LetGo(files_.front().path);
    bytes_ -= files_.front().bytes;
    files_.pop_front();
  }
}

}  // namespace rigcal
