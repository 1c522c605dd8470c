#include "storage/database/log_damage.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <ctime>
#include <map>
#include <thread>
#include <vector>

#include "server/base/files/file_descriptor.h"
#include "server/base/stamp.h"
#include "storage/database/page_sums.h"
#include "storage/database/write_ahead_log.h"
#include "storage/files/folders.h"

namespace rigcal::storage {
namespace {

namespace fs = std::filesystem;

constexpr int kLooks = 10;
constexpr std::chrono::milliseconds kBetweenLooks{20};

class ReadOnly {
 public:
  explicit ReadOnly(const fs::path& file) : file_(::open(file.c_str(), O_RDONLY | O_CLOEXEC)) {}
  [[nodiscard]] bool IsOpen() const { return file_.get() >= 0; }
  [[nodiscard]] std::int64_t Bytes() const { return Info().st_size; }
  [[nodiscard]] std::int64_t WrittenAt_s() const { return Info().st_mtim.tv_sec; }
  [[nodiscard]] bool Read(std::int64_t offset, std::span<unsigned char> bytes) const {
    return ::pread(file_.get(), bytes.data(), bytes.size(), offset) == static_cast<ssize_t>(bytes.size());
  }

 private:
  [[nodiscard]] struct stat Info() const {
    struct stat info {};
    static_cast<void>(::fstat(file_.get(), &info));  // all zero where it fails
    return info;
  }
  FileDescriptor file_;
};

LogLook LookOnce(const ReadOnly& log) {
  return LookAtLog([&](std::int64_t offset, std::span<unsigned char> bytes) { return log.Read(offset, bytes); },
                   log.Bytes());
}

// By the clock as it is now.
std::int64_t StartOfMachine_s() {
  timespec now{}, since_start{};
  clock_gettime(CLOCK_REALTIME, &now);
  clock_gettime(CLOCK_BOOTTIME, &since_start);
  return now.tv_sec - since_start.tv_sec;
}

// Who writes meanwhile makes no bad frame stay one under the same header: it is damage where two looks agree.
LogLook LookTwice(const ReadOnly& log) {
  std::array<unsigned char, 32> header{}, before{};
  LogLook look, last;
  for (int looks = 0; looks < kLooks; ++looks) {
    const bool has_header = log.Read(0, header);
    look = LookOnce(log);
    if (!look.is_damaged) return look;
    if (looks > 0 && has_header && header == before && look.stops_at == last.stops_at) return look;
    before = header;
    last = look;
    std::this_thread::sleep_for(kBetweenLooks);
  }
  return {};
}

using PageOf = std::map<std::uint32_t, std::vector<std::uint64_t>>;  // sums of what frames have of each page, in order

PageOf SumsOf(const ReadOnly& log, const std::vector<LogFrame>& frames) {
  std::array<unsigned char, kPageBytes> bytes{};
  PageOf sums;
  for (const LogFrame& frame : frames)
    if (log.Read(frame.offset + kLogFrameHeaderBytes, bytes))
      sums[frame.page].push_back(SumOfPage(frame.page - 1, bytes.data()));
  return sums;
}

std::uint64_t SumIn(const ReadOnly& database, std::uint32_t page) {
  std::array<unsigned char, kPageBytes> bytes{};
  return database.Read((page - std::int64_t{1}) * kPageBytes, bytes) ? SumOfPage(page - 1, bytes.data()) : 0;
}

// Checkpoints may have copied pages from behind the damage before there was any.
LogDamage::Kind KindOf(const LogLook& look, const ReadOnly& log, const fs::path& folder) {
  if (look.page_bytes != kPageBytes) return LogDamage::Kind::kNotRead;
  const ReadOnly database(DatabaseFile(folder));
  PageOf read = SumsOf(log, look.read);
  std::int64_t all = 0, newest = 0, newer = 0;
  for (const auto& [page, sums] : SumsOf(log, look.unread)) {
    const std::uint64_t older = read[page].empty() ? 0 : read[page].back(), stored = SumIn(database, page);
    if (older == sums.back()) continue;
    ++all;
    newest += stored == sums.back() ? 1 : 0;
    newer += stored != older && std::find(sums.begin(), sums.end(), stored) != sums.end() ? 1 : 0;
  }
  if (all > 0 && newest == all) return LogDamage::Kind::kStored;
  return newer > 0 ? LogDamage::Kind::kHalfStored : LogDamage::Kind::kNotRead;
}

std::optional<LogDamage> DamageIn(const ReadOnly& log, const fs::path& folder) {
  const LogLook look = LookTwice(log);
  if (!look.is_damaged) return std::nullopt;
  const LogDamage::Kind kind = KindOf(look, log, folder);
  // Then nothing is read that is older than the database: it is whole.
  if (kind == LogDamage::Kind::kStored && !look.has_header) return std::nullopt;
  return LogDamage{kind, look.stops_at, look.read_bytes, look.unread_commits};
}

// The index (wal-index) has two copies of its header, of 48 bytes, and then how many frames are in the database. Who
// closes a database in order removes it before the log.
std::int64_t FramesNotStored(const fs::path& folder) {
  constexpr int kCopyBytes = 48, kVersion = 3007000;
  std::array<unsigned char, 2 * kCopyBytes + 4> bytes{};
  const ReadOnly index(LogIndexFile(folder));
  if (!index.IsOpen() || !index.Read(0, bytes)) return 0;
  const auto word = [&](int at) {
    std::uint32_t value = 0;
    std::memcpy(&value, &bytes[static_cast<std::size_t>(at)], sizeof value);
    return value;
  };
  const bool is_used = word(0) == kVersion && bytes[12] == 1;
  const bool is_whole = std::equal(bytes.begin(), bytes.begin() + kCopyBytes, bytes.begin() + kCopyBytes);
  return is_used && is_whole ? std::int64_t{word(16)} - word(2 * kCopyBytes) : 0;
}

// Twice, as another process may be opening or closing the database.
bool HasMarkAlone(const fs::path& folder, struct stat& mark) {
  const auto has_log = [&] { return ::access(LogFile(folder).c_str(), F_OK) == 0; };
  return !has_log() && ::stat(LogMarkOf(DatabaseFile(folder)).c_str(), &mark) == 0 && !has_log();
}

std::string TextOf(const LogDamage& damage) {
  if (damage.kind == LogDamage::Kind::kGone)
    return " is not there, and the database lacks " + std::to_string(damage.commits) + " pages that were written to it";
  const std::string where = " is damaged at byte " + std::to_string(damage.at_byte) + ": ";
  const std::string commits = "at least " + std::to_string(damage.commits) + " commits behind it";
  if (damage.kind == LogDamage::Kind::kStored)
    return where + commits + " are in the database, and what SQLite would read of it is older";
  if (damage.kind == LogDamage::Kind::kHalfStored)
    return where + commits + " are in the database in part, and SQLite would read older pages over them";
  return where + commits + ", which were acknowledged, would not be read";
}

std::string CureOf(const LogDamage& damage, const std::string& folder) {
  const std::string repair = "`rigcal fsck --repair " + folder + "`";
  switch (damage.kind) {
    case LogDamage::Kind::kStored:
      return repair + " sets the log aside: nothing is lost.";
    case LogDamage::Kind::kHalfStored:
      return "Restore the newest backup into a new folder (`rigcal restore-backup`) and push again what came since.";
    case LogDamage::Kind::kGone:
      return "Put it back if it was moved away; else " + repair +
             " goes on without it: then push again what came since, or restore a newer backup.";
    case LogDamage::Kind::kNotRead:
      break;
  }
  return repair +
         " keeps a copy of it and goes on with what lies before that byte: then push again what came since, or restore "
         "a newer backup.";
}

}  // namespace

fs::path LogFile(const fs::path& folder) { return DatabaseFile(folder).string() + "-wal"; }
fs::path LogIndexFile(const fs::path& folder) { return DatabaseFile(folder).string() + "-shm"; }

// The mark first: who closes a database in order removes it before the log.
std::optional<LogDamage> FindLogDamage(const fs::path& folder) {
  const bool is_marked = ::access(LogMarkOf(DatabaseFile(folder)).c_str(), F_OK) == 0;
  const ReadOnly log(LogFile(folder));
  if (log.IsOpen()) return DamageIn(log, folder);
  std::error_code failed;
  if (!is_marked || fs::exists(LogFile(folder), failed)) return std::nullopt;
  const std::int64_t frames = FramesNotStored(folder);
  return frames > 0 ? std::optional(LogDamage{LogDamage::Kind::kGone, 0, 0, frames}) : std::nullopt;
}

Error ErrorOf(const LogDamage& damage, const fs::path& folder) {
  return {ErrorCode::kStorage, "the log " + LogFile(folder).string() + TextOf(damage), CureOf(damage, folder.string())};
}

Status RefuseDamagedLog(const fs::path& folder) {
  if (const auto damage = FindLogDamage(folder)) return Fail(ErrorOf(*damage, folder));
  return {};
}

std::optional<Error> LogInDoubt(const fs::path& folder) {
  const ReadOnly log(LogFile(folder));
  if (!log.IsOpen() || log.WrittenAt_s() < StartOfMachine_s()) return std::nullopt;
  const LogLook look = LookOnce(log);
  if (look.is_damaged || !look.lacks_commit) return std::nullopt;
  return Error{ErrorCode::kStorage,
               "the last commit in the log " + LogFile(folder).string() + ", at byte " + std::to_string(look.stops_at) +
                   ", cannot be read: it was under way when its process was killed, or "
                   "was damaged later",
               "Push again what was pushed last (what is there is not sent again), and look for the last decision in "
               "`rigcal audit`."};
}

std::optional<Error> LogThatWent(const fs::path& folder) {
  struct stat info {};
  const bool is_noted = ::stat(WentMarkOf(DatabaseFile(folder)).c_str(), &info) == 0;
  if (!is_noted && !HasMarkAlone(folder, info)) return std::nullopt;
  return Error{
      ErrorCode::kStorage,
      "the log " + LogFile(folder).string() +
          " went while no rigcald had closed it: what was pushed and decided last, until " +
          ToIso({static_cast<std::int64_t>(info.st_mtim.tv_sec) * 1'000'000'000}) + ", may be lost",
      "If another program (`sqlite3`) had opened the database, it wrote the log into it and nothing is; if the "
      "file was deleted, push again what came last (what is there is not sent again) and look for decisions "
      "in `rigcal audit`, or restore a newer backup. `rigcal fsck --repair` forgets this."};
}

void ForgetLogThatWent(const fs::path& folder) { ::unlink(WentMarkOf(DatabaseFile(folder)).c_str()); }

}  // namespace rigcal::storage
