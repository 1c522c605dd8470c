#include "server/pipeline/reports/retention.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "server/base/stamp.h"
#include "storage/revisions/revisions.h"
#include "storage/revisions/usable_revision.h"

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

}  // namespace rigcal::pipeline
