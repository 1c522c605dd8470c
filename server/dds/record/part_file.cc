#include "server/dds/record/part_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <iterator>
#include <string_view>

#include "server/base/files/file_descriptor.h"

namespace rigcal::dds {
namespace {

constexpr std::size_t kPiecesMax = 4096;
constexpr std::size_t kReadBytes = 1 << 20;

bool WriteAt(int fd, std::string_view bytes, std::uint64_t offset_bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(fd, bytes.data(), bytes.size(), static_cast<off_t>(offset_bytes));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
    offset_bytes += static_cast<std::uint64_t>(written);
  }
  return true;
}

}  // namespace

std::vector<ByteRange> ByteRanges::Add(ByteRange range) {
  std::vector<ByteRange> fresh;
  if (range.begin >= range.end) return fresh;
  auto next = end_by_begin_.upper_bound(range.begin);
  if (next != end_by_begin_.begin() && std::prev(next)->second >= range.begin) --next;
  ByteRange merged = range;
  std::uint64_t at = range.begin;
  while (next != end_by_begin_.end() && next->first <= range.end) {
    if (at < next->first) fresh.push_back({at, next->first});
    at = std::max(at, next->second);
    merged = {std::min(merged.begin, next->first), std::max(merged.end, next->second)};
    next = end_by_begin_.erase(next);
  }
  if (at < range.end) fresh.push_back({at, range.end});
  end_by_begin_.emplace(merged.begin, merged.end);
  return fresh;
}

bool ByteRanges::CoversUpTo(std::uint64_t end) const {
  const auto first = end_by_begin_.find(0);
  return end == 0 || (first != end_by_begin_.end() && first->second >= end);
}

void PartFile::Add(std::uint64_t offset_bytes, std::string bytes) {
  pieces_.push_back({offset_bytes, std::move(bytes)});
}

bool PartFile::Shattered() const { return ranges_.pieces() > kPiecesMax; }

Status PartFile::WritePiece(int fd, const Piece& piece) {
  for (const ByteRange& range : ranges_.Add({piece.offset_bytes, piece.offset_bytes + piece.bytes.size()})) {
    const auto fresh = std::string_view(piece.bytes).substr(range.begin - piece.offset_bytes, range.end - range.begin);
    if (!WriteAt(fd, fresh, range.begin)) return FileFailure(path_, "write", errno);
    if (range.begin != hashed_bytes_) continue;
    hash_.Add(fresh);
    hashed_bytes_ = range.end;
  }
  return {};
}

Status PartFile::Flush() {
  FileDescriptor file(::open(path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666));
  if (file.get() < 0) return FileFailure(path_, "open", errno);
  const auto earlier = [](const Piece& a, const Piece& b) { return a.offset_bytes < b.offset_bytes; };
  std::stable_sort(pieces_.begin(), pieces_.end(), earlier);
  for (const Piece& piece : pieces_) RIGCAL_TRY(WritePiece(file.get(), piece));
  pieces_.clear();
  if (!file.Close()) return FileFailure(path_, "write", errno);
  return {};
}

Result<Digest> PartFile::Hash() {
  if (hashed_bytes_ < size_bytes_) {
    RIGCAL_ASSIGN(const FileDescriptor file, OpenToRead(path_));
    std::string buffer(kReadBytes, '\0');
    if (::lseek(file.get(), static_cast<off_t>(hashed_bytes_), SEEK_SET) < 0) return FileFailure(path_, "read", errno);
    while (hashed_bytes_ < size_bytes_) {
      const std::ptrdiff_t got = ReadSome(file, buffer.data(), buffer.size());
      if (got <= 0) return FileFailure(path_, "read", got < 0 ? errno : EIO);
      hash_.Add(std::string_view(buffer).substr(0, static_cast<std::size_t>(got)));
      hashed_bytes_ += static_cast<std::uint64_t>(got);
    }
  }
  return hash_.Finish();
}

}  // namespace rigcal::dds
