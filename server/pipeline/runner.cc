#include "server/pipeline/runner.h"

#include <chrono>
#include <condition_variable>
#include <thread>
#include <vector>

#include "server/base/log.h"
#include "server/base/process/guarded.h"
#include "server/base/process/last_run.h"
#include "server/base/process/thread_rank.h"
#include "storage/work/attempts.h"

namespace rigcal::pipeline {
namespace {
// After a failure of the store (a full disk, say) the same step is tried again after this long.
constexpr std::int64_t kRetry_ns = 2'000'000'000;
constexpr std::chrono::hours kLongestStep{6};  // a large session on a small machine

// Work that was under way when the last run ended. It is not to blame where that came from outside.
Status NoteCutOffWork(storage::Store& store, const Clock& clock, RunEnd last_run) {
  RIGCAL_ASSIGN(const auto works, last_run == RunEnd::kFromOutside
                                      ? storage::EndKilledAttempts(store, clock.Now())
                                      : storage::EndOpenAttempts(store, storage::AttemptEnd::kCutOff, clock.Now()));
  for (const std::string& work : works) LogWarn("the server was stopped in the middle of " + work);
  return {};
}
}  // namespace

struct Runner::Impl {
  Options options;
  Announcer announcer;
  Vitals alone{SystemClock()};
  LiveGraphs live;
  RobotLocks locks;
  calib::CameraMemory cameras;
  SummaryTurn summaries;
  std::optional<WorkerPool> workers;
  std::unique_ptr<RobotLeases> leases;
  std::vector<storage::Store> stores;
  std::optional<storage::Store> own_store;
  std::mutex mutex;
  std::condition_variable changed;
  std::uint64_t wakes = 0;  // guarded by mutex
  bool stopping = false;    // guarded by mutex
  std::mutex reports_mutex;
  std::optional<RobotId> looked_at = RobotId();  // guarded by reports_mutex; absent: all were
  std::vector<std::thread> threads;

  void Loop(storage::Store& store, Part& part) {
    SetThreadRank(ThreadRank::kWorks);
    std::uint64_t seen = 0;
    GoRound(&part, [&] {
      if (!Seen(seen)) return false;
      part.Turn();
      Work(store, part, seen);
      return true;
    });
  }

  // One step, and where there was nothing to do the wait for more.
  void Work(storage::Store& store, Part& part, std::uint64_t seen) {
    const auto result = Guarded([&] {
      return Step({store, *options.clock, live, locks, announcer, cameras, options.undrawn,
                   workers ? &*workers : nullptr, &summaries, leases.get()});
    });
    if (!result) LogError(result.error());
    if (result && result->worked) Signal();  // its robot may be free for another thread now
    if (result && (result->worked || LookForReports(store))) return;
    part.Rest();
    Wait(seen, result ? result->wake_at : Stamp{options.clock->Now().ns + kRetry_ns});
  }

  // With nothing else to do, whether the newest reports of some robots are on disk. False once all were looked at.
  bool LookForReports(storage::Store& store) {
    const std::lock_guard lock(reports_mutex);
    if (!looked_at) return false;
    const auto last = DrawMissingReports(store, *looked_at);
    if (!last) LogError(last.error());
    looked_at = last && !last->empty() ? std::optional(*last) : std::nullopt;
    return true;
  }

  // Notes which wakes are covered by the step to come; false when stopping.
  bool Seen(std::uint64_t& seen) {
    const std::lock_guard lock(mutex);
    seen = wakes;
    return !stopping;
  }

  void Wait(std::uint64_t seen, std::optional<Stamp> wake_at) {
    std::unique_lock lock(mutex);
    const auto ready = [&] { return stopping || wakes != seen; };
    if (!wake_at) return changed.wait(lock, ready);
    changed.wait_for(lock, std::chrono::nanoseconds(wake_at->ns - options.clock->Now().ns), ready);
  }

  // What is cut off from here on is the doing of whoever stops the server.
  void GiveBackWork() {
    if (!own_store || threads.empty()) return;
    if (leases == nullptr) {
      const auto given_back =
          storage::EndOpenAttempts(*own_store, storage::AttemptEnd::kGivenBack, options.clock->Now());
      if (!given_back) LogError(given_back.error());
      return;
    }
    for (const RobotId& robot : locks.Taken()) {
      const auto lease = leases->HeldOf(robot);
      if (!lease) continue;
      const storage::Fenced fenced(*own_store, *lease);
      const auto given_back =
          storage::EndOpenAttempts(*own_store, robot, storage::AttemptEnd::kGivenBack, options.clock->Now());
      if (!given_back) LogError(given_back.error());
    }
  }

  void Signal() {
    {
      const std::lock_guard lock(mutex);
      ++wakes;
    }
    changed.notify_all();
  }

  ~Impl() {
    {
      const std::lock_guard lock(mutex);
      stopping = true;
    }
    changed.notify_all();
    const Status given_back = Guarded([this]() -> Status {
      GiveBackWork();
      return {};
    });
    if (!given_back) LogError(given_back.error());
    for (std::thread& thread : threads) thread.join();
  }
};

Runner::Runner(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Runner::~Runner() = default;
Runner::Runner(Runner&&) noexcept = default;
Runner& Runner::operator=(Runner&&) noexcept = default;

Result<Runner> Runner::Start(const Options& options, Announcer announcer) {
  auto impl = std::make_unique<Impl>();
  impl->options = options;
  impl->announcer = std::move(announcer);
  RIGCAL_ASSIGN(impl->own_store, storage::Store::Open(options.place));
  if (options.owner.empty()) {
    RIGCAL_TRY(NoteCutOffWork(*impl->own_store, *options.clock, EndOfLastRun(options.place.folder)));
    BeginRun(options.place.folder);
  } else {
    RIGCAL_ASSIGN(impl->leases, RobotLeases::Start(options.place, *options.clock, options.owner));
  }
  if (!options.worker.empty() && options.threads > 0) impl->workers.emplace(WorkerPool::Options{options.worker}).Warm();
  for (int i = 0; i < options.threads; ++i) {
    RIGCAL_ASSIGN(storage::Store store, storage::Store::Open(options.place));
    impl->stores.push_back(std::move(store));
  }
  Vitals& vitals = options.vitals == nullptr ? impl->alone : *options.vitals;
  for (storage::Store& store : impl->stores) {
    Part& part = vitals.Expect("calibration " + std::to_string(impl->threads.size() + 1), kLongestStep);
    impl->threads.emplace_back([&store, &part, raw = impl.get()] { raw->Loop(store, part); });
  }
  return Runner(std::move(impl));
}

void Runner::Wake() { impl_->Signal(); }

}  // namespace rigcal::pipeline
