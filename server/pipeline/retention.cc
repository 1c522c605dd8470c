#include "server/pipeline/retention.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "server/base/stamp.h"
#include "storage/revisions.h"

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

// `revisions` newest first.
std::set<int> NewestOfMonths(const std::vector<Revision>& revisions) {
  std::set<int> newest;
  std::string month;
  for (const Revision& revision : revisions)
    if (const std::string its = MonthOf(revision.created_at); its != month) {
      month = its;
      newest.insert(revision.number);
    }
  return newest;
}

std::int64_t OwnBytesOf(const fs::path& folder) {
  std::int64_t bytes = 0;
  std::error_code error;
  for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
    if (at->is_regular_file(error) && at->hard_link_count(error) == 1) bytes += static_cast<std::int64_t>(at->file_size(error));
  return bytes;
}

}  // namespace

Result<Freed> RemoveOldReports(storage::Store& store, const RobotId& robot, std::int64_t kept) {
  const fs::path folder = store.ReportFolder() / robot.str();
  const std::vector<int> numbers = NumbersIn(folder);
  RemoveLeftOvers(folder);
  if (static_cast<std::int64_t>(numbers.size()) <= kept) return Freed{};
  RIGCAL_ASSIGN(const auto revisions, storage::LoadRevisions(store, robot));
  RIGCAL_ASSIGN(const auto usable, storage::LoadUsableRevision(store, robot, 0));
  std::set<int> stay = NewestOfMonths(revisions);
  if (usable) stay.insert(usable->number);
  Freed freed;
  for (std::size_t i = static_cast<std::size_t>(kept); i < numbers.size(); ++i) {
    if (stay.contains(numbers[i])) continue;
    const fs::path report = folder / std::to_string(numbers[i]);
    const std::int64_t bytes = OwnBytesOf(report);
    const fs::path aside = folder / (".old-" + std::to_string(numbers[i]));
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
