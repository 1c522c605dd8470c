#include "storage/database/refused_pages.h"

#include <atomic>
#include <map>
#include <mutex>
#include <utility>

namespace rigcal::storage {
namespace {

struct AllRefused {
  std::mutex mutex;
  std::map<std::pair<std::filesystem::path, std::int64_t>, RefusedPage> pages;
  std::atomic<bool> are_some = false;  // most processes never have one, and read many pages
};

AllRefused& Refused() {
  static AllRefused refused;
  return refused;
}

thread_local std::optional<RefusedPage> last_refused;

// What is stored behind the damage would not be read at the next start.
Error ErrorOfLog(const RefusedPage& refused, const std::string& subject) {
  return {ErrorCode::kStorage,
          subject + ": the log " + refused.database.string() + "-wal is damaged at byte " +
              std::to_string(refused.log_at_byte) +
              ": the disk, or another program, has changed it, and nothing is stored any more",
          "Stop rigcald; `rigcal fsck " + refused.database.parent_path().string() +
              "` tells what of the log can be read, and the way on."};
}

}  // namespace

void NoteRefused(const RefusedPage& refused) {
  last_refused = refused;
  const std::lock_guard lock(Refused().mutex);
  Refused().pages.try_emplace({refused.database, refused.page}, refused);
  Refused().are_some = true;
}

void NoteGood(const std::filesystem::path& database, std::int64_t page) {
  if (!Refused().are_some) return;
  const std::lock_guard lock(Refused().mutex);
  Refused().pages.erase({database, page});
  Refused().are_some = !Refused().pages.empty();
}

std::optional<RefusedPage> TakeRefused() { return std::exchange(last_refused, std::nullopt); }

bool IsLogRefused(const std::filesystem::path& database) {
  if (!Refused().are_some) return false;
  const std::lock_guard lock(Refused().mutex);
  const auto log = Refused().pages.find({database, 0});
  if (log == Refused().pages.end()) return false;
  last_refused = log->second;
  return true;
}

Error ErrorOf(const RefusedPage& refused, const std::string& subject) {
  if (refused.page == 0) return ErrorOfLog(refused, subject);
  return {ErrorCode::kStorage,
          subject + ": page " + std::to_string(refused.page) + " of " + refused.database.string() +
              " is not as rigcald wrote it: the disk, or another program, has changed it",
          "Run `rigcal fsck " + refused.database.parent_path().string() +
              "`: it names what lies there. An index is made again with --repair; else restore the newest backup "
              "(`rigcal restore-backup`)."};
}

Status CheckNoneRefused(const std::filesystem::path& database) {
  if (!Refused().are_some) return {};
  std::error_code ignored;
  const std::filesystem::path file = std::filesystem::weakly_canonical(database, ignored);
  const std::lock_guard lock(Refused().mutex);
  const auto first = Refused().pages.lower_bound({file, 0});
  if (first == Refused().pages.end() || first->first.first != file) return {};
  return Fail(ErrorOf(first->second, "the database"));
}

}  // namespace rigcal::storage
