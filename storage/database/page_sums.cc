#include "storage/database/page_sums.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>

#include "server/base/digests/short_sum.h"
#include "server/base/files/durable_file.h"

namespace rigcal::storage {
namespace {

constexpr std::int64_t kSumBytes = sizeof(std::uint64_t);
constexpr const char *kSumsEnd = "-sums", *kMarkEnd = "-sums-log", *kLogEnd = "-wal", *kWentEnd = "-log-went";

// Needs no room on the disk and no handle; with one, power loss does not bring them back. Other connections have the
// file open: it stays the same one if that can be.
void ForgetAllIn(const std::filesystem::path& sums) {
  if (::truncate(sums.c_str(), 0) != 0 && errno != ENOENT) ::unlink(sums.c_str());
  static_cast<void>(SyncFile(sums));
}

int OpenSums(const std::filesystem::path& sums, bool to_note) {
  return ::open(sums.c_str(), (to_note ? O_RDWR | O_CREAT : O_RDONLY) | O_CLOEXEC, 0644);
}

std::filesystem::path With(const std::filesystem::path& database, const char* end) {
  std::filesystem::path file = database;
  file += end;
  return file;
}

}  // namespace

std::filesystem::path PageSumsFile(const std::filesystem::path& database) { return With(database, kSumsEnd); }

std::uint64_t SumOfPage(std::int64_t page_idx, const void* bytes) {
  const std::uint64_t sum = ShortSumOf(page_idx, {static_cast<const std::byte*>(bytes), std::size_t{kPageBytes}});
  return sum == 0 ? 1 : sum;
}

PageSums::PageSums(const std::filesystem::path& database, Access access)
    : file_(PageSumsFile(database)), access_(access), fd_(OpenSums(file_, access == Access::kNote)) {}

PageSums::~PageSums() {
  if (fd_ >= 0) ::close(fd_);
}

// Once more: there may have been no handle left when the database was opened.
bool PageSums::IsOpen() {
  if (fd_ < 0 && access_ == Access::kNote) fd_ = OpenSums(file_, true);
  return fd_ >= 0;
}

void PageSums::Forget() { ForgetAllIn(file_); }

void PageSums::Write(std::int64_t page_idx, std::uint64_t sum) {
  if (!IsOpen() || ::pwrite(fd_, &sum, kSumBytes, page_idx * kSumBytes) != kSumBytes) Forget();
}

void PageSums::Note(const void* bytes, int count, std::int64_t offset) {
  if (count == kPageBytes && offset % kPageBytes == 0)
    return Write(offset / kPageBytes, SumOfPage(offset / kPageBytes, bytes));
  for (std::int64_t page = offset / kPageBytes; page * kPageBytes < offset + count; ++page) Write(page, 0);
}

void PageSums::Truncate(std::int64_t database_bytes) {
  if (!IsOpen() || ::ftruncate(fd_, database_bytes / kPageBytes * kSumBytes) != 0) Forget();
}

void PageSums::Sync() {
  if (fd_ >= 0 && ::fdatasync(fd_) != 0) Forget();
}

std::uint64_t PageSums::Of(std::int64_t page_idx) {
  std::uint64_t sum = 0;
  return IsOpen() && ::pread(fd_, &sum, kSumBytes, page_idx * kSumBytes) == kSumBytes ? sum : 0;
}

std::filesystem::path LogMarkOf(const std::filesystem::path& database) { return With(database, kMarkEnd); }
std::filesystem::path WentMarkOf(const std::filesystem::path& database) { return With(database, kWentEnd); }

namespace {

// Salts and the lap, as SQLite begins a log; empty where it cannot be read.
std::string LogHeaderOf(const std::filesystem::path& file) {
  constexpr std::size_t kHeaderBytes = 32;
  std::string header(kHeaderBytes, '\0');
  const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return "";
  const bool is_read = ::pread(fd, header.data(), kHeaderBytes, 0) == static_cast<ssize_t>(kHeaderBytes);
  ::close(fd);
  return is_read ? header : "";
}

// The mark is the log itself by another name, so that no other log can be taken for it; or empty, where there are no
// links: then any log is its.
bool IsMarkOf(const std::filesystem::path& log, const std::filesystem::path& mark) {
  std::error_code failed;
  return std::filesystem::file_size(mark, failed) == 0 || std::filesystem::equivalent(log, mark, failed);
}

// In a folder that was copied the mark is a file of its own, which is as the log still is.
bool IsCopiedMarkOf(const std::filesystem::path& log, const std::filesystem::path& mark) {
  std::error_code failed;
  return std::filesystem::file_size(mark, failed) == std::filesystem::file_size(log, failed) &&
         LogHeaderOf(mark) == LogHeaderOf(log);
}

bool IsThere(const std::filesystem::path& file) { return ::access(file.c_str(), F_OK) == 0; }

}  // namespace

// The mark first: who makes a log makes it before its mark. The sums first: who is killed in between forgets them
// again.
void ForgetIfLogWent(const std::filesystem::path& database) {
  const std::filesystem::path mark = LogMarkOf(database), log = With(database, kLogEnd);
  if (!IsThere(mark) || (IsThere(log) && (IsMarkOf(log, mark) || IsCopiedMarkOf(log, mark)))) return;
  ForgetAllIn(PageSumsFile(database));
  static_cast<void>(::rename(mark.c_str(), WentMarkOf(database).c_str()));
}

// Needs no handle. Where no mark can be made, sums of pages that another program writes look like damage, and that is
// all. A copied one would not grow with the log.
void MarkLog(const std::filesystem::path& database, bool is_there) {
  const std::filesystem::path mark = LogMarkOf(database), log = With(database, kLogEnd);
  if (IsThere(mark) && !(is_there && IsMarkOf(log, mark))) ::unlink(mark.c_str());
  if (is_there && ::link(log.c_str(), mark.c_str()) != 0 && errno != EEXIST)
    static_cast<void>(::mknod(mark.c_str(), S_IFREG | 0644, 0));
}

}  // namespace rigcal::storage
