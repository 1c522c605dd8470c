#include "server/dds/tell/teller.h"

#include <algorithm>

#include "server/base/log.h"
#include "server/base/process/guarded.h"
#include "server/base/process/thread_rank.h"

namespace rigcal::dds {
namespace {

constexpr std::chrono::seconds kTellAgainFirst{1}, kTellAgainLast{64};  // what failed: twice as late from time to time

}  // namespace

void Teller::Put(const RobotId& robot, Time due) {
  const std::lock_guard lock(mutex_);
  const auto known = waiting_.due.find(robot);
  if (known != waiting_.due.end() && known->second <= due) return;
  waiting_.order.emplace(due, robot);  // first: what is in the order alone is told, too
  if (known != waiting_.due.end()) waiting_.order.erase({known->second, robot});
  waiting_.due[robot] = due;
  changed_.notify_one();
}

std::optional<RobotId> Teller::Next() {
  std::unique_lock lock(mutex_);
  while (!waiting_.stopped) {
    const Time due = waiting_.order.empty() ? Time::max() : waiting_.order.begin()->first;
    if (due <= std::chrono::steady_clock::now()) {
      const RobotId robot = waiting_.order.begin()->second;
      waiting_.order.erase(waiting_.order.begin());
      waiting_.due.erase(robot);
      return robot;
    }
    if (failing_.empty()) part_.Rest();
    if (waiting_.order.empty())
      changed_.wait(lock);
    else
      changed_.wait_until(lock, due);
  }
  return std::nullopt;
}

// Nobody is told anything older than what they were told before. Only this thread tells states, one after the other,
// each as its one connection finds it stored then, and a later snapshot is never older than an earlier one. So it does
// not matter that another thread stores a revision meanwhile: that one is put here once it is stored, is taken out of
// the queue before it is loaded, and so is told after what is being loaded. Nor does it matter that the robot's writers
// were ended and opened again in between.
Status Teller::Tell(const RobotId& robot) {
  if (!outbox_.IsHeardOf(robot)) return {};
  RIGCAL_ASSIGN(const auto state, callbacks_.state_of(store_, robot));
  return state ? outbox_.Tell(*state) : Status();
}

void Teller::TellOrRetry(const RobotId& robot) {
  const Status told = Guarded([&] { return Tell(robot); });
  if (told) {
    if (failing_.erase(robot) > 0 && failing_.empty()) part_.Turn();
    return;
  }
  const Error& error = told.error();
  part_.Fail({error.code, "the state of a robot could not be told: " + error.what, error.cure});
  const auto [again, is_first] = failing_.try_emplace(robot, kTellAgainFirst);
  if (is_first)
    LogError({error.code, "the state of robot " + robot.str() + " could not be told, it is tried again: " + error.what,
              error.cure});
  Put(robot, std::chrono::steady_clock::now() + again->second);
  again->second = std::min(2 * again->second, kTellAgainLast);
}

void Teller::Run() {
  SetThreadRank(ThreadRank::kWorks);
  GoRound(&part_, [this] {
    const auto robot = Next();
    if (!robot) return false;
    if (failing_.empty()) part_.Turn();
    OnceThereIsMemory([&] { TellOrRetry(*robot); });
    return true;
  });
}

void Teller::Stop() {
  const std::lock_guard lock(mutex_);
  waiting_.stopped = true;
  changed_.notify_one();
}

}  // namespace rigcal::dds
