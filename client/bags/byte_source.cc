#include "client/bags/byte_source.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "server/base/files/file_descriptor.h"

namespace rigcal::bags {
namespace {

class FileSource : public ByteSource {
 public:
  FileSource(FileDescriptor file, std::uint64_t size, std::string name)
      : file_(std::move(file)), size_(size), name_(std::move(name)) {}

  Result<std::size_t> ReadAt(std::uint64_t offset, std::span<std::byte> to) override {
    std::size_t done = 0;
    while (done < to.size()) {
      const ssize_t got = ::pread(file_.get(), to.data() + done, to.size() - done, static_cast<off_t>(offset + done));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) return FileFailure(name_, "read", errno);
      if (got == 0) break;
      done += static_cast<std::size_t>(got);
    }
    return done;
  }
  [[nodiscard]] std::uint64_t size() const override { return size_; }
  [[nodiscard]] const std::string& name() const override { return name_; }

 private:
  FileDescriptor file_;
  std::uint64_t size_;
  std::string name_;
};

class MemorySource : public ByteSource {
 public:
  MemorySource(std::span<const std::byte> bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}

  Result<std::size_t> ReadAt(std::uint64_t offset, std::span<std::byte> to) override {
    if (offset >= bytes_.size()) return std::size_t{0};
    const auto from = bytes_.subspan(static_cast<std::size_t>(offset));
    const std::size_t count = std::min(from.size(), to.size());
    if (count > 0) std::memcpy(to.data(), from.data(), count);
    return count;
  }
  [[nodiscard]] std::uint64_t size() const override { return bytes_.size(); }
  [[nodiscard]] const std::string& name() const override { return name_; }

 private:
  std::span<const std::byte> bytes_;
  std::string name_;
};

}  // namespace

Result<std::unique_ptr<ByteSource>> OpenSource(const std::filesystem::path& path) {
  return OpenSource(path, path.string());
}

Result<std::unique_ptr<ByteSource>> OpenSource(const std::filesystem::path& path, std::string name) {
  RIGCAL_ASSIGN(FileDescriptor file, OpenToRead(path));
  struct stat info = {};
  if (::fstat(file.get(), &info) != 0) return FileFailure(path, "read", errno);
  return std::make_unique<FileSource>(std::move(file), static_cast<std::uint64_t>(info.st_size), std::move(name));
}

std::unique_ptr<ByteSource> SourceOf(std::span<const std::byte> bytes, std::string name) {
  return std::make_unique<MemorySource>(bytes, std::move(name));
}

}  // namespace rigcal::bags
