#include "server/pipeline/robots/summaries.h"

#include <algorithm>
#include <map>

#include "server/base/log.h"
#include "server/pipeline/attempt.h"
#include "server/pipeline/robots/robot_summary.h"
#include "storage/fleet/robot_status.h"
#include "storage/fleet/robot_summary.h"

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

struct UnmadeSummary {
  RobotId robot;
  Error error;
};

struct WaitingMade {
  std::vector<MadeSummary> made;
  std::vector<UnmadeSummary> unmade;
  RobotId last;       // of those that were taken up
  bool full = false;  // there may be more
};

// What is damaged of one robot is no other's matter; where the store is held, it is held for all.
Result<WaitingMade> MakeWaiting(storage::Store& store, Stamp now, int max, const RobotId& after) {
  WaitingMade done;
  RIGCAL_TRY(store.Read([&]() -> Status {
    RIGCAL_ASSIGN(const auto waiting, storage::LoadWaitingSummaries(store, max, after));
    done.full = static_cast<int>(waiting.size()) == max;
    for (const storage::WaitingSummary& one : waiting) {
      auto summary = SummaryOrWhyNot(store, one.robot, now);
      done.last = one.robot;
      if (summary)
        done.made.push_back({std::move(*summary), one.changes});
      else if (summary.error().code == ErrorCode::kBusy)
        return Fail(summary.error());
      else
        done.unmade.push_back({one.robot, summary.error()});
    }
    return {};
  }));
  return done;
}

void TakeTurn(const WaitingMade& done, SummaryTurn& turn) {
  turn.after = done.last;
  for (const MadeSummary& one : done.made) turn.unmade.erase(one.summary.robot);
  for (const auto& [robot, error] : done.unmade)
    if (turn.unmade.insert(robot).second)
      LogError({error.code, "lists do not show what is new of robot " + robot.str() + ": " + error.what, error.cure});
}

// What that changes of a robot's status is told in the same transaction.
Status Keep(storage::Store& store, const std::vector<MadeSummary>& made, Stamp now) {
  for (const MadeSummary& one : made) {
    RIGCAL_TRY(storage::ReplaceSummary(store, one.summary, one.changes));
    RIGCAL_TRY(storage::NoteStatus(store, one.summary.robot, now));
  }
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

// In the place of those of the same robots, or where these would stand, of robots beyond `after`; then at most `max`.
void PutIn(std::vector<RobotSummary> newer, const RobotId& after, std::optional<std::int64_t> max,
           std::vector<RobotSummary>& rows) {
  std::erase_if(newer, [&](const RobotSummary& one) { return !(after < one.robot); });
  if (newer.empty()) return;
  std::map<RobotId, RobotSummary> by_id;
  for (std::vector<RobotSummary>* part : {&newer, &rows})
    for (RobotSummary& one : *part) by_id.try_emplace(one.robot, std::move(one));
  rows.clear();
  for (auto& [robot, summary] : by_id)
    if (!max || static_cast<std::int64_t>(rows.size()) < *max) rows.push_back(std::move(summary));
}

}  // namespace

Result<RefreshedSummaries> RefreshSummaries(storage::Store& store, const Clock& clock, int max, SummaryTurn& turn) {
  RIGCAL_ASSIGN(const WaitingMade done, MakeWaiting(store, clock.Now(), max, turn.after));
  TakeTurn(done, turn);
  if (!done.made.empty()) RIGCAL_TRY(store.Write([&] { return Keep(store, done.made, clock.Now()); }));
  return RefreshedSummaries{static_cast<int>(done.made.size()), done.full && !done.made.empty()};
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
  return made.empty() ? Status{} : store.Write([&] { return Keep(store, made, clock.Now()); });
}

void RefreshAllSummaries(storage::Store& store, const Clock& clock) {
  SummaryTurn turn;
  Result<RefreshedSummaries> refreshed = RefreshedSummaries{0, true};
  int all = 0;
  for (; refreshed && refreshed->more; all += refreshed ? refreshed->made : 0)
    refreshed = RefreshSummaries(store, clock, kAtOnceMax, turn);
  if (!refreshed) LogError(refreshed.error());
  if (all > 0) LogInfo("the summaries of " + std::to_string(all) + " robots were worked out");
}

std::vector<RobotSummary> FreshenSummaries(storage::Store& store, const Clock& clock) {
  auto done = MakeWaiting(store, clock.Now(), kFreshenedMax, RobotId());
  std::vector<RobotSummary> not_kept;
  if (!done || done->made.empty() || store.WriteSoon([&] { return Keep(store, done->made, clock.Now()); }))
    return not_kept;
  for (MadeSummary& one : done->made) not_kept.push_back(std::move(one.summary));  // the next one keeps them
  return not_kept;
}

Result<RobotList> LoadRobotList(storage::Store& store, const Clock& clock, const formats::Parameters& parameters) {
  RIGCAL_ASSIGN(const std::optional<std::int64_t> limit, LimitOf(parameters));
  RIGCAL_ASSIGN(const RobotId after, AfterOf(parameters));
  std::vector<RobotSummary> not_kept = FreshenSummaries(store, clock);
  RobotList list;
  // One more tells whether any follows.
  const auto max = limit ? std::optional(*limit + 1) : std::nullopt;
  RIGCAL_ASSIGN(list.robots, storage::LoadSummaries(store, after, max, clock.Now()));
  PutIn(std::move(not_kept), after, max, list.robots);
  if (!limit) return list;
  list.next = RobotId();
  if (static_cast<std::int64_t>(list.robots.size()) <= *limit) return list;
  list.robots.pop_back();
  list.next = list.robots.back().robot;
  return list;
}

}  // namespace rigcal::pipeline
