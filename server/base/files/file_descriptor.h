// Owns an open file; closes it when it goes.
#pragma once

#include <cerrno>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "server/base/result.h"

namespace rigcal {

class FileDescriptor {
 public:
  // Takes `fd` over; negative, as of a failed open(), owns nothing.
  explicit FileDescriptor(int fd) : fd_(fd) {}
  FileDescriptor(FileDescriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~FileDescriptor();
  [[nodiscard]] int get() const { return fd_; }                   // negative: none
  [[nodiscard]] int Release() { return std::exchange(fd_, -1); }  // the caller owns it now
  // Closes now and reports: some file systems report a failed write only here.
  [[nodiscard]] bool Close();

 private:
  int fd_;
};

// A regular file, for reading. kNotFound if it is missing, kInvalidInput if it is a folder or a device.
[[nodiscard]] Result<FileDescriptor> OpenToRead(const std::filesystem::path& path);
// Up to `count` bytes, 0 at the end; retries after a signal. Negative: errno says why.
[[nodiscard]] std::ptrdiff_t ReadSome(const FileDescriptor& file, char* bytes, std::size_t count);
// "<path>: cannot <verb> (<reason of errno>)", kStorage or kNotFound.
[[nodiscard]] tl::unexpected<Error> FileFailure(const std::filesystem::path& path, std::string_view verb, int error);

}  // namespace rigcal
