#include "storage/upkeep/copy_verified.h"

#include <fcntl.h>
#include <unistd.h>

#include <optional>
#include <vector>

#include "server/base/files/file_descriptor.h"

namespace rigcal::storage {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPieceBytes = 1 << 20;

fs::path HalfName(const fs::path& to) { return to.string() + ".tmp-" + std::to_string(::getpid()); }

bool WritePiece(const FileDescriptor& file, const char* bytes, std::size_t count) {
  while (count > 0) {
    const ssize_t written = ::write(file.get(), bytes, count);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes += written;
    count -= static_cast<std::size_t>(written);
  }
  return true;
}

// On its way to the disk, and out of memory: else the sync at the end would hold up all who write meanwhile, and what
// the server reads would have to make room.
void LetGo(const FileDescriptor& file) {
  ::sync_file_range(file.get(), 0, 0, SYNC_FILE_RANGE_WAIT_BEFORE | SYNC_FILE_RANGE_WRITE | SYNC_FILE_RANGE_WAIT_AFTER);
  ::posix_fadvise(file.get(), 0, 0, POSIX_FADV_DONTNEED);
}

// The digest of what was read, and how much; nothing where the source cannot be read to its end.
struct Streamed {
  std::optional<Digest> digest;
  std::int64_t bytes = 0;
};
Result<Streamed> Stream(const FileDescriptor& from, const fs::path& half) {
  FileDescriptor to(::open(half.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644));
  if (to.get() < 0) return FileFailure(half, "create", errno);
  std::vector<char> piece(kPieceBytes);
  Sha256 hash;
  Streamed streamed;
  for (std::ptrdiff_t got = 0; (got = ReadSome(from, piece.data(), piece.size())) != 0;) {
    if (got < 0) return streamed;
    hash.Add(std::string_view(piece.data(), static_cast<std::size_t>(got)));
    if (!WritePiece(to, piece.data(), static_cast<std::size_t>(got))) return FileFailure(half, "write", errno);
    streamed.bytes += got;
  }
  LetGo(to);
  if (!to.Close()) return FileFailure(half, "write", errno);
  streamed.digest = hash.Finish();
  return streamed;
}

Status Replace(const fs::path& half, const fs::path& to) {
  if (::rename(half.c_str(), to.c_str()) == 0) return {};
  const int error = errno;
  ::unlink(half.c_str());
  return FileFailure(to, "replace", error);
}

// False: not on this file system.
Result<bool> Link(const fs::path& from, const fs::path& to) {
  const fs::path half = HalfName(to);
  ::unlink(half.c_str());
  if (::link(from.c_str(), half.c_str()) != 0) return false;
  RIGCAL_TRY(Replace(half, to));
  ::unlink(half.c_str());  // rename leaves it where both were the same file already
  return true;
}

Result<Copied> CopyBytes(const fs::path& from, const fs::path& to, const Digest& digest) {
  const Result<FileDescriptor> source = OpenToRead(from);
  if (!source && source.error().code == ErrorCode::kNotFound) return Copied{BlobState::kMissing, 0};
  if (!source) return Fail(source.error());
  const fs::path half = HalfName(to);
  const auto streamed = Stream(*source, half);
  const bool is_good = streamed && streamed->digest == digest;
  if (!is_good) ::unlink(half.c_str());
  if (!streamed) return Fail(streamed.error());
  if (!is_good) return Copied{BlobState::kDamaged, 0};
  RIGCAL_TRY(Replace(half, to));
  return Copied{BlobState::kGood, streamed->bytes};
}

BlobState StateOf(const fs::path& file, const Digest& digest) {
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return BlobState::kMissing;
  const auto found = Sha256OfFile(file);
  return found && *found == digest ? BlobState::kGood : BlobState::kDamaged;
}

}  // namespace

Result<Copied> CopyVerified(const fs::path& from, const fs::path& to, const Digest& digest, CopyHow how) {
  if (how == CopyHow::kCopy) return CopyBytes(from, to, digest);
  const BlobState state = StateOf(from, digest);
  if (state != BlobState::kGood) return Copied{state, 0};
  RIGCAL_ASSIGN(const bool linked, Link(from, to));
  if (linked) return Copied{BlobState::kGood, 0};
  return CopyBytes(from, to, digest);
}

Status SyncFileSystem(const fs::path& folder) {
  const FileDescriptor file(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (file.get() < 0) return FileFailure(folder, "open", errno);
  if (::syncfs(file.get()) != 0) return FileFailure(folder, "sync", errno);
  return {};
}

}  // namespace rigcal::storage
