#include "server/sites/forwarder.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <set>
#include <thread>

#include "server/base/log.h"
#include "server/base/process/guarded.h"
#include "server/base/process/thread_rank.h"
#include "server/sites/send.h"
#include "storage/sites/forward_queue.h"

namespace rigcal::sites {
namespace {

constexpr std::int64_t kFirstPause_ns = 1'000'000'000, kPauseMax_ns = 60'000'000'000;
constexpr std::int64_t kRefusedAgain_ns = 3'600'000'000'000;  // somebody may have mended what was refused
constexpr std::chrono::seconds kLookAgain{5}, kPauseAfterSilence{30}, kRoundMax{120}, kAskAgainWhetherKept{3600};
constexpr int kBusyFailuresMax = 3;  // a busy centre is asked again soon

std::string NameOf(const storage::WaitingForward& one) {
  return (one.is_batch ? "batch " : "session ") + one.subject + " of robot " + one.robot.str();
}

}  // namespace

std::int64_t LinkRetryAfter_ns(int failures) {
  constexpr int kDoublingsMax = 6;  // beyond a minute
  return std::min(kFirstPause_ns << std::clamp(failures - 1, 0, kDoublingsMax), kPauseMax_ns);
}

struct Forwarder::Impl {
  Options options;
  Vitals alone{SystemClock()};
  Part* part = nullptr;
  std::optional<storage::Store> store;
  std::optional<CentreLink> link;
  std::atomic<bool> stopping = false;
  std::mutex mutex;
  std::condition_variable changed;
  bool woken = false;                                  // guarded by mutex
  int failures = 0;                                    // of the centre, one after the other
  std::chrono::steady_clock::time_point next_look{};   // at what is in use there
  std::chrono::steady_clock::time_point kept_until{};  // it is not asked before whether it has what it confirmed
  std::set<Digest> told;
  std::thread thread;

  bool WentOn() {
    part->Turn();
    return !stopping;
  }

  // One that was away may be one restored from an older backup: it lacks what it confirmed last, and is offered all of
  // it again. Before anything else is sent, as that would be what it confirmed last. Some of each robot: of what a
  // version of before confirmed a clock says the order.
  Status AskWhetherKept() {
    const auto now = std::chrono::steady_clock::now();
    if (now < kept_until) return {};
    RIGCAL_ASSIGN(const auto newest, storage::LoadNewestForwarded(*store));
    for (const storage::WaitingForward& one : newest) {
      RIGCAL_ASSIGN(const bool is_there,
                    one.is_batch ? link->HasBatch(BatchId(one.subject)) : link->HasSession(SessionId(one.subject)));
      if (is_there) continue;
      LogWarn("the centre " + options.centre.url + " has no longer " + NameOf(one) +
              ", which it confirmed: all that it confirmed is sent again");
      RIGCAL_TRY(storage::ForwardAgain(*store));
      break;
    }
    kept_until = now + kAskAgainWhetherKept;
    return {};
  }

  Status Send(const storage::WaitingForward& next) {
    if (failures > 0) RIGCAL_TRY(link->Greet());  // whose answer tells most of what is wrong
    RIGCAL_TRY(AskWhetherKept());
    if (next.is_batch) return SendBatch(*store, *link, BatchId(next.subject));
    return SendSession(*store, *link, SessionId(next.subject));
  }

  // True if the next may go out at once.
  Result<bool> SendNext() {
    const Clock& clock = *options.clock;
    RIGCAL_ASSIGN(const auto next, storage::LoadNextForward(*store, clock.Now()));
    if (!next) return false;
    const Status sent = Send(*next);
    if (!sent && stopping) return false;
    if (sent) return Confirm(*next);
    if (IsOfTheWay(sent.error().code)) return Pause(*next, sent.error());
    LogWarn(NameOf(*next) + " is not at the centre: " + Sentence(sent.error()));
    const Stamp now = clock.Now();
    RIGCAL_TRY(storage::NoteForwardFailure(*store, *next, Sentence(sent.error()), {now.ns + kRefusedAgain_ns}, now));
    return true;
  }

  Result<bool> Confirm(const storage::WaitingForward& next) {
    RIGCAL_TRY(storage::MarkForwarded(*store, next, options.clock->Now()));
    if (failures > 0) LogInfo("the centre " + options.centre.url + " takes what robots push again");
    failures = 0;
    LogInfo(NameOf(next) + " is on the centre's disk");
    return true;
  }

  Result<bool> Pause(const storage::WaitingForward& next, const Error& error) {
    if (++failures == 1) LogWarn("the centre " + options.centre.url + ": " + Sentence(error) + " What is pushed waits");
    if (error.code == ErrorCode::kBusy) failures = std::min(failures, kBusyFailuresMax);
    kept_until = {};
    RIGCAL_TRY(storage::NoteForwardFailure(*store, next, Sentence(error), {}, options.clock->Now()));
    return false;
  }

  // Where the centre does not answer it is asked again; that it does not is told once something is to be sent.
  Status LookAtCentre() {
    const auto now = std::chrono::steady_clock::now();
    if (!options.give || failures > 0 || now < next_look) return {};
    next_look = now + kLookAgain;
    const Status done = Look();
    if (done || !IsOfTheWay(done.error().code)) return done;
    next_look = now + kPauseAfterSilence;
    kept_until = {};
    return {};
  }

  Status Look() {
    RIGCAL_TRY(AskWhetherKept());
    const auto give = [this](const std::string& verb, const std::string& json) {
      part->Turn();
      return options.give(verb, json);
    };
    return TakeOver(*store, *link, give, told);
  }

  // What is wrong with what is in use there holds up nothing that is to be sent.
  Result<bool> GoOn() {
    const Status looked = LookAtCentre();
    RIGCAL_ASSIGN(const bool more, SendNext());
    if (!looked && !more) return Fail(looked.error());
    return more;
  }

  void Wait() {
    const std::chrono::nanoseconds pause(failures > 0 ? LinkRetryAfter_ns(failures) : 0);
    std::unique_lock lock(mutex);
    if (failures > 0)
      changed.wait_for(lock, pause, [&] { return stopping.load(); });
    else
      changed.wait_for(lock, kLookAgain, [&] { return stopping || woken; });
    woken = false;
  }

  void Run() {
    SetThreadRank(ThreadRank::kWorks);
    while (!stopping) {
      part->Turn();
      Result<bool> more = Guarded([&] { return GoOn(); });
      if (more && *more) continue;
      if (!more) part->Fail(std::move(more).error());
      if (more) part->Rest();
      Wait();
    }
  }

  Status Open() {
    const bool is_shared = !options.place.server.empty();
    if (options.centre.url.empty() && is_shared) return {};  // another server of the store may have one
    RIGCAL_ASSIGN(store, storage::Store::Open(options.place));
    RIGCAL_TRY(storage::SetCentre(*store, options.centre.url, options.clock->Now()));
    return {};
  }

  void Begin() {
    Vitals& vitals = options.vitals == nullptr ? alone : *options.vitals;
    part = &vitals.Expect("centre", kRoundMax);
    link.emplace(options.centre, [this] { return WentOn(); });
    thread = std::thread([this] { Run(); });
  }

  ~Impl() {
    {
      const std::lock_guard lock(mutex);
      stopping = true;
    }
    changed.notify_all();
    if (thread.joinable()) thread.join();
  }
};

Forwarder::Forwarder(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Forwarder::~Forwarder() = default;
Forwarder::Forwarder(Forwarder&&) noexcept = default;
Forwarder& Forwarder::operator=(Forwarder&&) noexcept = default;

Result<Forwarder> Forwarder::Start(const Options& options) {
  if (!options.centre.url.empty()) RIGCAL_TRY(CheckCentre(options.centre));
  auto impl = std::make_unique<Impl>();
  impl->options = options;
  RIGCAL_TRY(impl->Open());
  if (!options.centre.url.empty()) impl->Begin();
  return Forwarder(std::move(impl));
}

void Forwarder::Wake() {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->woken = true;
  }
  impl_->changed.notify_all();
}

}  // namespace rigcal::sites
