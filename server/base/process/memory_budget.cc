#include "server/base/process/memory_budget.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include "server/base/limits_in_force.h"

namespace rigcal {
namespace {

namespace fs = std::filesystem;
constexpr std::int64_t kUnlimited = std::numeric_limits<std::int64_t>::max();

// A file with one number; "max", no file and no number: no limit.
std::int64_t NumberIn(const fs::path& file) {
  std::int64_t bytes = 0;
  return std::ifstream(file) >> bytes && bytes > 0 ? bytes : kUnlimited;
}

// The group's own limit and those of the groups around it.
std::int64_t LimitOfGroup(const fs::path& root, fs::path group, const char* file) {
  std::int64_t bytes = NumberIn(root / file);
  for (group = group.relative_path(); !group.empty(); group = group.parent_path())
    bytes = std::min(bytes, NumberIn(root / group / file));
  return bytes;
}

// /proc/self/cgroup has a line "number:controllers:group" per hierarchy; that of version 2 names no controllers.
std::int64_t LimitOfControlGroups() {
  std::int64_t bytes = kUnlimited;
  std::ifstream groups("/proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1), group = line.substr(second + 1);
    if (controllers.empty()) bytes = std::min(bytes, LimitOfGroup("/sys/fs/cgroup", group, "memory.max"));
    if (("," + controllers + ",").find(",memory,") != std::string::npos)
      bytes = std::min(bytes, LimitOfGroup("/sys/fs/cgroup/memory", group, "memory.limit_in_bytes"));
  }
  return bytes;
}

std::int64_t LimitOf(__rlimit_resource resource) {
  rlimit limit{};
  if (getrlimit(resource, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kUnlimited;
  return static_cast<std::int64_t>(std::min<rlim_t>(limit.rlim_cur, kUnlimited));
}

// rigcald with its 83 threads had reserved 1.4 GB.
std::int64_t AddressSpaceToUse() {
  constexpr std::int64_t kReserved = 3LL << 29;
  const std::int64_t limit = LimitOf(RLIMIT_AS);
  return limit == kUnlimited ? kUnlimited : std::max<std::int64_t>(0, limit - kReserved);
}

}  // namespace

MemoryBudget::Share::~Share() {
  if (give_back_) give_back_();
}

void MemoryBudget::Return(std::int64_t bytes) {
  {
    const std::lock_guard lock(mutex_);
    taken_bytes_ -= bytes;
  }
  given_back_.notify_all();
}

std::optional<MemoryBudget::Share> MemoryBudget::Take(std::int64_t bytes) {
  const std::int64_t bytes_max = bytes_max_();
  if (bytes > bytes_max) return std::nullopt;
  if (ask_) return Share(ask_(bytes));
  std::unique_lock lock(mutex_);
  const std::uint64_t number = next_number_++;
  given_back_.wait(lock, [&] { return turn_ == number && taken_bytes_ + bytes <= bytes_max; });
  ++turn_;
  taken_bytes_ += bytes;
  lock.unlock();
  given_back_.notify_all();  // the next in turn may fit beside
  return Share([this, bytes] { Return(bytes); });
}

MemoryBudget& DecodingBudget() {
  static MemoryBudget& budget =
      *new MemoryBudget([] { return limits::InForce().decoded_bytes; });  // a thread may wait for it to the end
  return budget;
}

std::int64_t MemoryOfProcess() {
  const std::int64_t machine = std::int64_t{sysconf(_SC_PHYS_PAGES)} * sysconf(_SC_PAGESIZE);
  return std::min({machine, LimitOfControlGroups(), AddressSpaceToUse(), LimitOf(RLIMIT_DATA)});
}

}  // namespace rigcal
