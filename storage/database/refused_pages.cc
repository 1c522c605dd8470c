#include "storage/database/refused_pages.h"

#include <atomic>
#include <mutex>
#include <set>
#include <utility>

namespace rigcal::storage {
namespace {

struct AllRefused {
  std::mutex mutex;
  std::set<std::pair<std::filesystem::path, std::int64_t>> pages;
  std::atomic<bool> are_some = false;  // most processes never have one, and read many pages
};

AllRefused& Refused() {
  static AllRefused refused;
  return refused;
}

thread_local std::optional<RefusedPage> last_refused;

}  // namespace

void NoteRefused(const RefusedPage& refused) {
  last_refused = refused;
  const std::lock_guard lock(Refused().mutex);
  Refused().pages.emplace(refused.database, refused.page);
  Refused().are_some = true;
}

void NoteGood(const std::filesystem::path& database, std::int64_t page) {
  if (!Refused().are_some) return;
  const std::lock_guard lock(Refused().mutex);
  Refused().pages.erase({database, page});
  Refused().are_some = !Refused().pages.empty();
}

std::optional<RefusedPage> TakeRefused() { return std::exchange(last_refused, std::nullopt); }

Error ErrorOf(const RefusedPage& refused, const std::string& subject) {
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
  if (first == Refused().pages.end() || first->first != file) return {};
  return Fail(ErrorOf({first->first, first->second}, "the database"));
}

}  // namespace rigcal::storage
