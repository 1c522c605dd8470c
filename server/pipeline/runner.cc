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

// What threads that have nothing to do wait for.
class RunnerAlarm {
 public:
  void Ring() {
    Note([this] { ++rings_; });
  }
  // Rings for all but who is at what it `heard`, and does.
  void RingOthers(std::uint64_t& heard) {
    Note([&] {
      if (heard == rings_) ++heard;
      ++rings_;
    });
  }
  void Stop() {
    Note([this] { stopped_ = true; });
  }
  // Notes which rings are covered by what is done next; false once it is stopped.
  bool Hear(std::uint64_t& heard) {
    const std::lock_guard lock(mutex_);
    heard = rings_;
    return !stopped_;
  }
  // Until it rings again, or is stopped; so long at most.
  void Wait(std::uint64_t heard, std::optional<std::chrono::nanoseconds> most) {
    std::unique_lock lock(mutex_);
    const auto ready = [&] { return stopped_ || rings_ != heard; };
    if (!most) return changed_.wait(lock, ready);
    changed_.wait_for(lock, *most, ready);
  }

 private:
  template <typename Change>
  void Note(const Change& change) {
    {
      const std::lock_guard lock(mutex_);
      change();
    }
    changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::uint64_t rings_ = 0;  // guarded by mutex_, as the next
  bool stopped_ = false;
};

// Whether the newest reports of robots are on disk, of some of them at a time.
class ReportSearch {
 public:
  // False once all were looked at.
  bool LookAtSome(storage::Store& store) {
    const std::lock_guard lock(mutex_);
    if (!looked_at_) return false;
    const auto last = DrawMissingReports(store, *looked_at_);
    if (!last) LogError(last.error());
    looked_at_ = last && !last->empty() ? std::optional(*last) : std::nullopt;
    return true;
  }

 private:
  std::mutex mutex_;
  std::optional<RobotId> looked_at_ = RobotId();  // guarded by mutex_; absent: all were
};

// What the steps of all threads share.
struct SharedByThreads {
  Announcer announcer;
  LiveGraphs live;
  RobotLocks locks;
  calib::CameraMemory cameras;
  SummaryTurn summaries;
  std::optional<WorkerPool> workers;
  std::unique_ptr<RobotLeases> leases;
};

struct Runner::Impl {
  Options options;
  Vitals alone{SystemClock()};
  SharedByThreads shared;
  std::vector<storage::Store> stores;
  std::optional<storage::Store> own_store;
  RunnerAlarm alarm;
  ReportSearch reports;
  std::vector<std::thread> threads;

  void Loop(storage::Store& store, Part& part, bool takes_jobs) {
    SetThreadRank(ThreadRank::kWorks);
    std::uint64_t seen = 0;
    GoRound(&part, [&] {
      if (!alarm.Hear(seen)) return false;
      part.Turn();
      Work(store, part, takes_jobs, seen);
      return true;
    });
  }

  // One step, and where there was nothing to do the wait for more.
  void Work(storage::Store& store, Part& part, bool takes_jobs, std::uint64_t seen) {
    const std::uint64_t given_back = shared.locks.given_back();
    const auto result = Guarded([&] {
      return Step({store, *options.clock, shared.live, shared.locks, shared.announcer, shared.cameras, options.undrawn,
                   shared.workers ? &*shared.workers : nullptr, &shared.summaries, shared.leases.get(), takes_jobs});
    });
    if (!result) LogError(result.error());
    if (result && result->worked)
      alarm.Ring();  // its robot may be free for another thread now
    else if (!takes_jobs && shared.locks.given_back() != given_back)
      alarm.RingOthers(seen);
    if (result && (result->worked || reports.LookAtSome(store))) return;
    part.Rest();
    const std::int64_t now_ns = options.clock->Now().ns;
    const auto wake_at = result ? result->wake_at : Stamp{now_ns + kRetry_ns};
    alarm.Wait(seen, wake_at ? std::optional(std::chrono::nanoseconds(wake_at->ns - now_ns)) : std::nullopt);
  }

  // What is cut off from here on is the doing of whoever stops the server.
  void GiveBackWork() {
    if (!own_store || threads.empty()) return;
    if (shared.leases == nullptr) {
      const auto given_back =
          storage::EndOpenAttempts(*own_store, storage::AttemptEnd::kGivenBack, options.clock->Now());
      if (!given_back) LogError(given_back.error());
      return;
    }
    for (const RobotId& robot : shared.locks.Taken()) {
      const auto lease = shared.leases->HeldOf(robot);
      if (!lease) continue;
      const storage::Fenced fenced(*own_store, *lease);
      const auto given_back =
          storage::EndOpenAttempts(*own_store, robot, storage::AttemptEnd::kGivenBack, options.clock->Now());
      if (!given_back) LogError(given_back.error());
    }
  }

  ~Impl() {
    alarm.Stop();
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
  impl->shared.announcer = std::move(announcer);
  RIGCAL_ASSIGN(impl->own_store, storage::Store::Open(options.place));
  if (options.owner.empty()) {
    RIGCAL_TRY(NoteCutOffWork(*impl->own_store, *options.clock, EndOfLastRun(options.place.folder)));
    BeginRun(options.place.folder);
  } else {
    RIGCAL_ASSIGN(impl->shared.leases, RobotLeases::Start(options.place, *options.clock, options.owner));
  }
  if (!options.worker.empty() && options.threads > 0)
    impl->shared.workers.emplace(WorkerPool::Options{options.worker}).Warm();
  for (int i = 0; options.threads > 0 && i < options.threads + 1; ++i) {
    RIGCAL_ASSIGN(storage::Store store, storage::Store::Open(options.place));
    impl->stores.push_back(std::move(store));
  }
  Vitals& vitals = options.vitals == nullptr ? impl->alone : *options.vitals;
  for (storage::Store& store : impl->stores) {
    const std::size_t number = impl->threads.size() + 1;
    const bool takes_jobs = number < impl->stores.size();
    Part& part = vitals.Expect(takes_jobs ? "calibration " + std::to_string(number) : "revisions", kLongestStep);
    impl->threads.emplace_back([&store, &part, takes_jobs, raw = impl.get()] { raw->Loop(store, part, takes_jobs); });
  }
  return Runner(std::move(impl));
}

void Runner::Wake() { impl_->alarm.Ring(); }

}  // namespace rigcal::pipeline
