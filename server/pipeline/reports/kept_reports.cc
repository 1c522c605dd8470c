#include "server/pipeline/reports/kept_reports.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <set>

#include "server/base/log.h"
#include "server/base/stamp.h"
#include "server/pipeline/attempt.h"
#include "storage/revisions/decisions.h"
#include "storage/revisions/revisions.h"
#include "storage/work/attempts.h"

namespace rigcal::pipeline {
namespace {

namespace fs = std::filesystem;

// Numbers of the reports that are there, the newest first.
std::vector<int> NumbersIn(const fs::path& folder) {
  std::vector<int> numbers;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    const std::string name = at->path().filename().string();
    if (!name.empty() && name.size() < 10 && name.find_first_not_of("0123456789") == std::string::npos)
      numbers.push_back(std::stoi(name));
  }
  std::sort(numbers.rbegin(), numbers.rend());
  return numbers;
}

// Of a removal that was cut off.
void RemoveLeftOvers(const fs::path& folder) {
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
    if (at->path().filename().string().starts_with(".old-")) fs::remove_all(at->path(), error);
}

std::string MonthOf(Stamp stamp) { return ToIso(stamp).substr(0, 7); }

// Of `numbers` those of revisions after which none was made in the same month.
Result<std::set<int>> NewestOfMonths(storage::Store& store, const RobotId& robot, const std::vector<int>& numbers) {
  std::vector<int> asked = numbers;
  for (const int number : numbers) asked.push_back(number + 1);
  RIGCAL_ASSIGN(const auto created_at, storage::LoadCreatedAt(store, robot, asked));
  std::set<int> newest;
  for (const int number : numbers) {
    const auto own = created_at.find(number), next = created_at.find(number + 1);
    if (own == created_at.end()) continue;
    if (next == created_at.end() || MonthOf(own->second) != MonthOf(next->second)) newest.insert(number);
  }
  return newest;
}

std::int64_t OwnBytesOf(const fs::path& folder) {
  std::int64_t bytes = 0;
  std::error_code error;
  for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
    if (at->is_regular_file(error) && at->hard_link_count(error) == 1)
      bytes += static_cast<std::int64_t>(at->file_size(error));
  return bytes;
}

constexpr std::ptrdiff_t kQueuedOfRobotMax = 3;  // whoever walks through all old reports has them one after the other
constexpr const char* kSoon = "Ask for it again in a few seconds.";

std::string ReportOf(const storage::RevisionKey& key) {
  return "the report of revision " + std::to_string(key.number) + " of " + key.robot.str();
}

bool IsThere(const storage::Store& store, const storage::RevisionKey& key, const std::string& file = "index.html") {
  std::error_code error;
  return std::filesystem::exists(store.ReportFolder() / key.robot.str() / std::to_string(key.number) / file, error);
}

// Reports of the robot that are still to be drawn, but for those that were given up.
Result<std::ptrdiff_t> QueuedOf(storage::Store& store, const RobotId& robot) {
  RIGCAL_ASSIGN(const auto queued, storage::LoadUnpublished(store));
  RIGCAL_ASSIGN(const auto attempts, storage::LoadAttemptCounts(store));
  return std::count_if(queued.begin(), queued.end(), [&](const storage::RevisionKey& one) {
    const auto count = attempts.find(storage::WorkOfReport(one));
    return one.robot == robot && (count == attempts.end() || count->second < kPublishAttemptsMax);
  });
}

// True if it was not to be drawn before.
Result<bool> Queue(storage::Store& store, const storage::RevisionKey& key) {
  RIGCAL_ASSIGN(const bool is_new, storage::QueuePublication(store, key));
  if (is_new) LogInfo(ReportOf(key) + " is not whole in " + store.ReportFolder().string() + ": it is drawn again");
  return is_new;
}

Error Being(const storage::RevisionKey& key, const char* drawn) {
  return {ErrorCode::kBusy, ReportOf(key) + " is being " + drawn, kSoon};
}

// Drawing it ended the server so often that it is not begun again.
std::optional<Error> GivenUp(storage::Store& store, const storage::RevisionKey& key) {
  const auto attempts = storage::LoadAttempts(store, storage::WorkOfReport(key));
  const auto counts = storage::LoadAttemptCounts(store);
  if (!attempts || !counts) return std::nullopt;
  const auto count = counts->find(storage::WorkOfReport(key));
  if (count == counts->end() || count->second < kPublishAttemptsMax || attempts->under_way) return std::nullopt;
  return Error{ErrorCode::kNotFound, ReportOf(key) + " could not be drawn: " + WhyGivenUp(*attempts, "made it"),
               "Give the server more memory, or report it with the server's log."};
}

}  // namespace

Result<Freed> RemoveOldReports(storage::Store& store, const RobotId& robot, std::int64_t kept) {
  const fs::path folder = store.ReportFolder() / robot.str();
  const std::vector<int> numbers = NumbersIn(folder);
  RemoveLeftOvers(folder);
  if (static_cast<std::int64_t>(numbers.size()) <= kept) return Freed{};
  const std::vector<int> older(numbers.begin() + kept, numbers.end());
  RIGCAL_ASSIGN(std::set<int> stay, NewestOfMonths(store, robot, older));
  RIGCAL_ASSIGN(const auto usable, storage::LoadStillUsable(store, robot));
  if (usable) stay.insert(usable->number);
  Freed freed;
  for (const int number : older) {
    if (stay.contains(number)) continue;
    const fs::path report = folder / std::to_string(number);
    const std::int64_t bytes = OwnBytesOf(report);
    const fs::path aside = folder / (".old-" + std::to_string(number));
    std::error_code error;
    fs::rename(report, aside, error);  // at once, for whoever reads
    if (!error) fs::remove_all(aside, error);
    if (error)
      return Fail(ErrorCode::kStorage, "the old report " + report.string() + " cannot be removed: " + error.message(),
                  "Check the permissions of the data folder.");
    ++freed.reports, freed.bytes += bytes;
  }
  return freed;
}

void UndrawnReports::Note(const storage::RevisionKey& key, const Error& error) {
  const std::lock_guard lock(mutex_);
  why_.insert_or_assign({key.robot, key.number}, error);
}

void UndrawnReports::Forget(const storage::RevisionKey& key) {
  const std::lock_guard lock(mutex_);
  why_.erase({key.robot, key.number});
}

std::optional<Error> UndrawnReports::Find(const storage::RevisionKey& key) const {
  const std::lock_guard lock(mutex_);
  const auto found = why_.find({key.robot, key.number});
  return found == why_.end() ? std::nullopt : std::optional(found->second);
}

Error WhyMissing(storage::Store& store, const UndrawnReports& undrawn, const storage::RevisionKey& key,
                 const std::string& file, const std::function<void()>& drawn_soon) {
  const auto revision = storage::LoadRevisionSummary(store, key.robot, key.number);
  if (!revision) return revision.error();
  if (!*revision)
    return {ErrorCode::kNotFound, key.robot.str() + " has no revision " + std::to_string(key.number),
            "See the robot's own page for those that it has."};
  if (IsThere(store, key, file)) return Being(key, "drawn");  // it came since it was missed
  if (IsThere(store, key))
    return {ErrorCode::kNotFound, ReportOf(key) + " has no file " + file, "Start at the report's first page."};
  if (const auto why = undrawn.Find(key))
    return {ErrorCode::kNotFound, ReportOf(key) + " could not be drawn: " + why->what, why->cure};
  if (const auto given_up = GivenUp(store, key)) return *given_up;
  const auto queued = QueuedOf(store, key.robot);
  if (!queued) return queued.error();
  if (*queued >= kQueuedOfRobotMax) return Being(key, "drawn after others of this robot");
  const auto is_new = Queue(store, key);
  if (!is_new) return is_new.error();
  if (*is_new && drawn_soon) drawn_soon();
  const auto published = storage::IsPublished(store, key);
  return published && *published ? Being(key, "drawn again, as its folder was gone") : Being(key, "drawn");
}

Result<RobotId> DrawMissingReports(storage::Store& store, const RobotId& after) {
  constexpr int kLookedAtOnce = 256;
  RIGCAL_ASSIGN(const auto newest, storage::LoadNewestRevisions(store, after, kLookedAtOnce));
  std::vector<storage::RevisionKey> gone;
  for (const storage::RevisionKey& key : newest)
    if (key.number > 0 && !IsThere(store, key)) gone.push_back(key);
  if (!gone.empty())
    RIGCAL_TRY(store.Write([&]() -> Status {
      for (const storage::RevisionKey& key : gone) RIGCAL_TRY(Queue(store, key));
      return {};
    }));
  return newest.empty() ? RobotId() : newest.back().robot;
}

}  // namespace rigcal::pipeline
