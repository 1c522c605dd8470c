#include "client/wire/file_pieces.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

namespace rigcal::client {
namespace fs = std::filesystem;
namespace {

std::optional<FileMark> MarkOf(const fs::path& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0 || !S_ISREG(info.st_mode)) return std::nullopt;
  return FileMark{info.st_size, info.st_mtim.tv_sec * 1'000'000'000LL + info.st_mtim.tv_nsec, info.st_ino};
}

// Reads exactly piece.size() bytes; false at an early end or an error.
bool ReadAt(int file, std::uint64_t offset_bytes, std::string& piece) {
  std::size_t done = 0;
  while (done < piece.size()) {
    const ssize_t count =
        ::pread(file, piece.data() + done, piece.size() - done, static_cast<off_t>(offset_bytes + done));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    done += static_cast<std::size_t>(count);
  }
  return true;
}

}  // namespace

FileMarks MarkFiles(const fs::path& folder) {
  FileMarks marks;
  std::error_code error;
  auto item = fs::recursive_directory_iterator(folder, fs::directory_options::skip_permission_denied, error);
  for (; !error && item != fs::recursive_directory_iterator(); item.increment(error))
    if (const auto mark = MarkOf(item->path())) marks[item->path().lexically_relative(folder).generic_string()] = *mark;
  return marks;
}

FilePieces::FilePieces(fs::path folder, std::vector<Payload> payloads, FileMarks marks)
    : folder_(std::move(folder)), payloads_(std::move(payloads)), marks_(std::move(marks)) {}

Error FilePieces::Changed(std::uint32_t payload_idx) const {
  return {
      ErrorCode::kInvalidInput,
      (folder_ / payloads_[payload_idx].path).string() + " changed, or can no longer be read, while it was being sent",
      "Let nothing write to the folder, then push it again: what is already on the server is not sent twice"};
}

Status FilePieces::Check(std::uint32_t payload_idx) const {
  const Payload& payload = payloads_[payload_idx];
  const auto before = marks_.find(payload.path);
  const auto now = MarkOf(folder_ / payload.path);
  if (before == marks_.end() || !now || *now != before->second || now->size_bytes != payload.size_bytes)
    return Fail(Changed(payload_idx));
  return {};
}

Status FilePieces::CheckAll() const {
  for (std::uint32_t i = 0; i < payloads_.size(); ++i) RIGCAL_TRY(Check(i));
  return {};
}

Result<const std::string*> FilePieces::Read(const ChunkAt& chunk) {
  if (!file_ || open_idx_ != chunk.payload_idx) {
    file_.reset();
    RIGCAL_ASSIGN(FileDescriptor file, OpenToRead(folder_ / payloads_[chunk.payload_idx].path));
    file_.emplace(std::move(file));
    open_idx_ = chunk.payload_idx;
  }
  piece_.resize(chunk.size_bytes);
  const bool is_whole = ReadAt(file_->get(), chunk.offset_bytes, piece_);
  RIGCAL_TRY(Check(chunk.payload_idx));
  if (!is_whole) return Fail(Changed(chunk.payload_idx));
  return &piece_;
}

}  // namespace rigcal::client
