#include "server/pipeline/summaries.h"

#include <algorithm>

#include "server/base/log.h"
#include "server/pipeline/attempt.h"
#include "server/pipeline/robot_summary.h"
#include "storage/robot_summary.h"

namespace rigcal::pipeline {
namespace {

constexpr int kFreshenedMax = 64, kAtOnceMax = 1024;

struct MadeSummary {
  RobotSummary summary;
  std::int64_t changes = 0;  // of the robot until it was made
};

// A robot of which something that is stored cannot be read keeps no other waiting.
Result<RobotSummary> SummaryOrWhyNot(storage::Store& store, const RobotId& robot, Stamp now) {
  auto summary = LoadRobotSummary(store, robot, now);
  if (summary || IsOurFault(summary.error())) return summary;
  const Error& error = summary.error();
  RobotSummary unreadable;
  unreadable.robot = robot;
  unreadable.verdict = {VerdictLevel::kUnknown, "What is stored of it cannot be read: " + error.what + ".", error.cure};
  return unreadable;
}

Result<std::vector<MadeSummary>> MakeWaiting(storage::Store& store, Stamp now, int max) {
  std::vector<MadeSummary> made;
  RIGCAL_TRY(store.Read([&]() -> Status {
    RIGCAL_ASSIGN(const auto waiting, storage::LoadWaitingSummaries(store, max));
    for (const storage::WaitingSummary& one : waiting) {
      RIGCAL_ASSIGN(auto summary, SummaryOrWhyNot(store, one.robot, now));
      made.push_back({std::move(summary), one.changes});
    }
    return {};
  }));
  return made;
}

Status Keep(storage::Store& store, const std::vector<MadeSummary>& made) {
  for (const MadeSummary& one : made) RIGCAL_TRY(storage::ReplaceSummary(store, one.summary, one.changes));
  return {};
}

// Absent: all.
Result<std::optional<std::int64_t>> LimitOf(const formats::Parameters& parameters) {
  constexpr std::int64_t kLimitMax = 1'000'000'000;
  if (!parameters.Text("limit")) return std::nullopt;
  RIGCAL_ASSIGN(const std::int64_t limit, parameters.IntegerOr("limit", 0));
  if (limit >= 1) return std::min(limit, kLimitMax);
  return Fail(ErrorCode::kInvalidInput, "the parameter 'limit' is less than 1", "Give the number of robots to list.");
}

Result<RobotId> AfterOf(const formats::Parameters& parameters) {
  const auto after = parameters.Text("after");
  return after ? RobotId::Parse(*after) : RobotId();
}

}  // namespace

Result<int> RefreshSummaries(storage::Store& store, const Clock& clock, int max) {
  RIGCAL_ASSIGN(const auto made, MakeWaiting(store, clock.Now(), max));
  if (!made.empty()) RIGCAL_TRY(store.Write([&] { return Keep(store, made); }));
  return static_cast<int>(made.size());
}

Status RefreshSummary(storage::Store& store, const Clock& clock, const RobotId& robot) {
  std::vector<MadeSummary> made;
  RIGCAL_TRY(store.Read([&]() -> Status {
    RIGCAL_ASSIGN(const auto waiting, storage::LoadWaitingSummary(store, robot));
    if (!waiting) return {};
    RIGCAL_ASSIGN(auto summary, LoadRobotSummary(store, robot, clock.Now()));
    made.push_back({std::move(summary), waiting->changes});
    return {};
  }));
  return made.empty() ? Status{} : store.Write([&] { return Keep(store, made); });
}

void RefreshAllSummaries(storage::Store& store, const Clock& clock) {
  Result<int> refreshed = kAtOnceMax;
  int all = 0;
  for (; refreshed && *refreshed == kAtOnceMax; all += refreshed.value_or(0))
    refreshed = RefreshSummaries(store, clock, kAtOnceMax);
  if (!refreshed) LogError(refreshed.error());
  if (all > 0) LogInfo("the summaries of " + std::to_string(all) + " robots were worked out");
}

void FreshenSummaries(storage::Store& store, const Clock& clock) {
  const auto made = MakeWaiting(store, clock.Now(), kFreshenedMax);
  if (!made || made->empty()) return;
  static_cast<void>(store.WriteSoon([&] { return Keep(store, *made); }));  // or the next one does
}

Result<RobotList> LoadRobotList(storage::Store& store, const Clock& clock, const formats::Parameters& parameters) {
  RIGCAL_ASSIGN(const std::optional<std::int64_t> limit, LimitOf(parameters));
  RIGCAL_ASSIGN(const RobotId after, AfterOf(parameters));
  FreshenSummaries(store, clock);
  RobotList list;
  // One more tells whether any follows.
  const auto max = limit ? std::optional(*limit + 1) : std::nullopt;
  RIGCAL_ASSIGN(list.robots, storage::LoadSummaries(store, after, max, clock.Now()));
  if (!limit) return list;
  list.next = RobotId();
  if (static_cast<std::int64_t>(list.robots.size()) <= *limit) return list;
  list.robots.pop_back();
  list.next = list.robots.back().robot;
  return list;
}

}  // namespace rigcal::pipeline
