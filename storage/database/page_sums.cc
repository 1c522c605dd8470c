#include "storage/database/page_sums.h"

#include <fcntl.h>
#include <unistd.h>

#include <span>
#include <string>

#include "server/base/digests/sha256.h"

namespace rigcal::storage {
namespace {

constexpr std::int64_t kSumBytes = sizeof(std::uint64_t);

}  // namespace

std::filesystem::path PageSumsFile(const std::filesystem::path& database) {
  std::filesystem::path file = database;
  file += "-sums";
  return file;
}

std::uint64_t SumOfPage(std::int64_t page_idx, const void* bytes) {
  Sha256 hash;
  hash.Add(std::as_bytes(std::span(&page_idx, 1)));
  hash.Add(std::span(static_cast<const std::byte*>(bytes), static_cast<std::size_t>(kPageBytes)));
  const std::uint64_t sum = std::stoull(hash.Finish().str().substr(0, 16), nullptr, 16);
  return sum == 0 ? 1 : sum;
}

PageSums::PageSums(const std::filesystem::path& database, Access access)
    : fd_(::open(PageSumsFile(database).c_str(), (access == Access::kLook ? O_RDONLY : O_RDWR | O_CREAT) | O_CLOEXEC, 0644)) {
  if (fd_ < 0 && access == Access::kNote) ::unlink(PageSumsFile(database).c_str());
}

PageSums::~PageSums() {
  if (fd_ >= 0) ::close(fd_);
}

void PageSums::Forget() {
  // Needs no room on the disk.
  if (fd_ >= 0 && ::ftruncate(fd_, 0) != 0) ::unlink(("/proc/self/fd/" + std::to_string(fd_)).c_str());
}

void PageSums::Write(std::int64_t page_idx, std::uint64_t sum) {
  if (fd_ >= 0 && ::pwrite(fd_, &sum, kSumBytes, page_idx * kSumBytes) != kSumBytes) Forget();
}

void PageSums::Note(const void* bytes, int count, std::int64_t offset) {
  if (count == kPageBytes && offset % kPageBytes == 0) return Write(offset / kPageBytes, SumOfPage(offset / kPageBytes, bytes));
  for (std::int64_t page = offset / kPageBytes; page * kPageBytes < offset + count; ++page) Write(page, 0);
}

void PageSums::Truncate(std::int64_t database_bytes) {
  if (fd_ >= 0 && ::ftruncate(fd_, database_bytes / kPageBytes * kSumBytes) != 0) Forget();
}

void PageSums::Sync() {
  if (fd_ >= 0 && ::fdatasync(fd_) != 0) Forget();
}

std::uint64_t PageSums::Of(std::int64_t page_idx) const {
  std::uint64_t sum = 0;
  return fd_ >= 0 && ::pread(fd_, &sum, kSumBytes, page_idx * kSumBytes) == kSumBytes ? sum : 0;
}

}  // namespace rigcal::storage
