#include "storage/database/log_guard.h"

#include <array>

#include "storage/database/page_sums.h"

namespace rigcal::storage {
namespace {

constexpr std::int64_t kFrameBytes = kLogFrameHeaderBytes + kPageBytes;
// Of the index, in words (https://sqlite.org/walformat.html): the last frame that is committed, and how many are in the
// database.
constexpr int kCommittedAt = 4, kStoredAt = 24;
constexpr int kLooks = 4;  // at a frame that looks damaged: it may have been misread

std::int64_t OffsetOf(std::int64_t frame) { return kLogHeaderBytes + (frame - 1) * kFrameBytes; }

}  // namespace

std::int64_t LogGuard::Committed() const { return index_ == nullptr || !read_ ? 0 : index_[kCommittedAt]; }
std::int64_t LogGuard::Stored() const { return index_ == nullptr ? 0 : index_[kStoredAt]; }

std::optional<std::int64_t> LogGuard::FaultIn(std::span<const unsigned char> bytes, std::int64_t offset) const {
  const std::int64_t begin = offset - kLogFrameHeaderBytes, in_frames = begin - kLogHeaderBytes;
  if (bytes.size() != kPageBytes || in_frames < 0 || in_frames % kFrameBytes != 0) return std::nullopt;
  if (in_frames / kFrameBytes + 1 > Committed()) return std::nullopt;
  bool is_unread = false;
  const LogReader read = [&](std::int64_t at, std::span<unsigned char> into) {
    const bool is_read = read_(at, into);
    is_unread |= !is_read;
    return is_read;
  };
  return IsFrameGood(read, begin, bytes) || is_unread ? std::nullopt : std::optional(begin);
}

std::optional<std::int64_t> LogGuard::FaultToStore() const {
  std::array<unsigned char, kPageBytes> bytes{};
  const std::int64_t committed = Committed();
  for (std::int64_t frame = Stored() + 1; frame <= committed; ++frame) {
    const std::int64_t page_at = OffsetOf(frame) + kLogFrameHeaderBytes;
    std::optional<std::int64_t> fault;
    for (int look = 0; look == 0 || (fault && look < kLooks); ++look)
      fault = read_(page_at, bytes) ? FaultIn(bytes, page_at) : std::nullopt;
    if (fault) return fault;
  }
  return std::nullopt;
}

}  // namespace rigcal::storage
