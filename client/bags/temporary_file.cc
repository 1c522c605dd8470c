#include "client/bags/temporary_file.h"

#include <fcntl.h>
#include <unistd.h>
#include <zstd.h>

#include <cerrno>
#include <cstdlib>
#include <new>
#include <vector>

#include "client/bags/limits.h"
#include "server/base/files/file_descriptor.h"

namespace rigcal::bags {
namespace {

constexpr std::size_t kPieceBytes = 1 << 20;
constexpr const char* kCure = "What could be unpacked is given; copy the bag again from where it was recorded.";

Status WriteAll(const FileDescriptor& file, const std::filesystem::path& path, const char* bytes, std::size_t count) {
  while (count > 0) {
    const ssize_t done = ::write(file.get(), bytes, count);
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) return FileFailure(path, "write", errno);
    bytes += done;
    count -= static_cast<std::size_t>(done);
  }
  return {};
}

// Takes the file piece by piece; what it gave so far is in `to` whatever happens.
class Unpacking {
 public:
  Unpacking(const FileDescriptor& to, const std::filesystem::path& path)
      : to_(to), path_(path), context_(ZSTD_createDCtx(), ZSTD_freeDCtx) {
    if (!context_) throw std::bad_alloc();
  }
  // The name of zstd's trouble, or null.
  Result<const char*> Take(const char* bytes, std::size_t count) {
    ZSTD_inBuffer in{bytes, count, 0};
    std::size_t given = 0;
    do {
      ZSTD_outBuffer out{piece_.data(), piece_.size(), 0};
      const std::size_t hint = ZSTD_decompressStream(context_.get(), &out, &in);
      if (ZSTD_isError(hint) != 0U) return ZSTD_getErrorName(hint);
      whole_ = hint == 0;
      given = out.pos;
      written_ += given;
      if (written_ > limits::kPackedFileBytesMax)
        return Fail(ErrorCode::kInvalidInput,
                    path_.string() + " unpacks to more than " + std::to_string(limits::kPackedFileBytesMax) + " bytes",
                    "Unpack it with zstd, and split it.");
      RIGCAL_TRY(WriteAll(to_, path_, piece_.data(), given));
    } while (in.pos < in.size || given == piece_.size());
    return nullptr;
  }
  [[nodiscard]] bool whole() const { return whole_; }

 private:
  const FileDescriptor& to_;
  const std::filesystem::path& path_;
  std::unique_ptr<ZSTD_DCtx, std::size_t (*)(ZSTD_DCtx*)> context_;
  std::vector<char> piece_ = std::vector<char>(kPieceBytes);
  std::uint64_t written_ = 0;
  bool whole_ = false;
};

}  // namespace

Result<std::unique_ptr<TemporaryFile>> TemporaryFile::Make(const std::string& suffix) {
  std::error_code failed;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(failed);
  std::string name = ((failed ? std::filesystem::path(".") : folder) / ("rigcal-XXXXXX" + suffix)).string();
  const FileDescriptor file(::mkstemps(name.data(), static_cast<int>(suffix.size())));
  if (file.get() < 0) return FileFailure(name, "make", errno);
  return std::unique_ptr<TemporaryFile>(new TemporaryFile(name));
}

TemporaryFile::~TemporaryFile() {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

namespace {

Status UnpackInto(const FileDescriptor& unpacked, const std::filesystem::path& from,
                  const std::function<void(Error)>& told) {
  RIGCAL_ASSIGN(const FileDescriptor packed, OpenToRead(from));
  Unpacking unpacking(unpacked, from);
  std::vector<char> piece(kPieceBytes);
  for (;;) {
    const std::ptrdiff_t got = ReadSome(packed, piece.data(), piece.size());
    if (got < 0) return FileFailure(from, "read", errno);
    if (got == 0) break;
    RIGCAL_ASSIGN(const char* trouble, unpacking.Take(piece.data(), static_cast<std::size_t>(got)));
    if (trouble == nullptr) continue;
    told({ErrorCode::kInvalidInput, from.string() + ": its zstd data is damaged (" + trouble + ")", kCure});
    return {};
  }
  if (!unpacking.whole()) told({ErrorCode::kInvalidInput, from.string() + ": its zstd data ends early", kCure});
  return {};
}

// Of a file without a name; it takes the place of an empty one.
Status GiveName(const FileDescriptor& file, const std::filesystem::path& name) {
  const std::string nameless = "/proc/self/fd/" + std::to_string(file.get());
  if (::unlink(name.c_str()) == 0 &&
      ::linkat(AT_FDCWD, nameless.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0)
    return {};
  return FileFailure(name, "make", errno);
}

}  // namespace

Status UnpackZstdFile(const std::filesystem::path& from, const std::filesystem::path& to,
                      const std::function<void(Error)>& told) {
  const FileDescriptor nameless(::open(to.parent_path().c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600));
  if (nameless.get() >= 0) {
    RIGCAL_TRY(UnpackInto(nameless, from, told));
    return GiveName(nameless, to);
  }
  const FileDescriptor named(::open(to.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600));
  if (named.get() < 0) return FileFailure(to, "write", errno);
  return UnpackInto(named, from, told);
}

}  // namespace rigcal::bags
