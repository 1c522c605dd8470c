#include "server/webhook/sender.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <set>
#include <thread>

#include "server/base/log.h"
#include "server/base/process/guarded.h"
#include "server/base/process/thread_rank.h"
#include "storage/alerts/outbox.h"
#include "storage/fleet/robot_status.h"
#include "storage/store.h"

namespace rigcal::webhook {
namespace {

constexpr std::int64_t kFirstRetry_ns = 1'000'000'000, kDay_ns = 86'400'000'000'000;
constexpr std::chrono::seconds kLookAgain{5}, kStatusesAgain{30}, kRoundMax{120};
constexpr int kStatusesAtOnce = 256;
constexpr std::chrono::milliseconds kClaim{kPostMax_ms + 5'000};  // longer than a post may take

bool IsTaken(int http_status) { return http_status >= 200 && http_status < 300; }

// It is the receiver that does not work, not this alert that it refuses.
bool IsDown(const Result<int>& answer) { return !answer || *answer >= 500 || *answer == 429; }

std::string WhyNot(const Result<int>& answer) {
  return answer ? "it answered HTTP status " + std::to_string(*answer) : answer.error().what;
}

Status CheckAll(const std::vector<Receiver>& receivers) {
  std::set<std::string> urls;
  for (const Receiver& one : receivers) {
    RIGCAL_TRY(CheckReceiver(one));
    if (!urls.insert(one.url).second)
      return Fail(ErrorCode::kInvalidInput, "--webhook " + storage::ShownUrl(one.url) + " is given twice",
                  "Give it once.");
  }
  return {};
}

}  // namespace

std::int64_t RetryAfter_ns(int attempts) {
  constexpr int kDoublingsMax = 17;  // beyond a day
  return std::min(kFirstRetry_ns << std::clamp(attempts - 1, 0, kDoublingsMax), kDay_ns);
}

struct Sender::Impl {
  Options options;
  Vitals alone{SystemClock()};
  std::vector<storage::Store> stores;
  std::atomic<bool> stopping = false;
  std::mutex mutex;
  std::condition_variable changed;
  std::uint64_t wakes = 0;  // guarded by mutex
  std::vector<std::thread> threads;

  // Until somebody wakes, or for so long.
  void Wait(std::uint64_t& seen, std::chrono::nanoseconds at_most) {
    std::unique_lock lock(mutex);
    changed.wait_for(lock, at_most, [&] { return stopping || wakes != seen; });
    seen = wakes;
  }

  // Those whose date came, and those of summaries that were never noted.
  Result<bool> NoteStatuses(storage::Store& store) {
    const Stamp now = options.clock->Now();
    RIGCAL_ASSIGN(const auto robots, storage::LoadChangedStatuses(store, now, kStatusesAtOnce));
    if (robots.empty()) return false;
    RIGCAL_TRY(store.Write([&]() -> Status {
      for (const RobotId& robot : robots) RIGCAL_TRY(storage::NoteStatus(store, robot, now));
      return {};
    }));
    Wake();
    return static_cast<int>(robots.size()) == kStatusesAtOnce;
  }

  void WatchStatuses(storage::Store& store, Part& part) {
    SetThreadRank(ThreadRank::kServes);
    while (!stopping) {
      part.Turn();
      Result<bool> more = Guarded([&] { return NoteStatuses(store); });
      if (!more) part.Fail(std::move(more).error());
      if (more && *more) continue;
      if (more) part.Rest();
      std::unique_lock lock(mutex);
      changed.wait_for(lock, kStatusesAgain, [&] { return stopping.load(); });
    }
  }

  // Notes what came of it. The receiver is left alone until the stamp, if there is one.
  Result<Stamp> Conclude(storage::Store& store, const Receiver& receiver, const WaitingAlert& next,
                         const Result<int>& answer, int failures) {
    const Stamp now = options.clock->Now();
    const std::int64_t number = next.alert.number;
    if (answer && IsTaken(*answer)) {
      RIGCAL_TRY(storage::MarkDelivered(store, receiver.url, number, *answer, now));
      return Stamp{};
    }
    const bool down = IsDown(answer);
    const Stamp again{now.ns + RetryAfter_ns(down ? failures : next.attempts + 1)};
    RIGCAL_TRY(storage::NoteAttempt(store, receiver.url, number, WhyNot(answer), again));
    return down ? again : Stamp{};
  }

  void SendTo(storage::Store& store, const Receiver& receiver, Part& part) {
    SetThreadRank(ThreadRank::kServes);
    std::uint64_t seen = 0;
    int failures = 0;  // of the receiver, one after the other
    Stamp paused_until;
    while (!stopping) {
      part.Turn();
      const Stamp now = options.clock->Now();
      const bool paused = now < paused_until && paused_until.ns - now.ns <= kDay_ns;  // else the clock was set back
      auto sent =
          paused ? Result<bool>(false) : Guarded([&] { return SendNext(store, receiver, failures, paused_until); });
      if (!sent) part.Fail(std::move(sent).error());
      if (sent && *sent) continue;
      if (sent) part.Rest();
      Wait(seen, UntilNext(paused_until));
    }
  }

  // True if the next may go out at once.
  Result<bool> SendNext(storage::Store& store, const Receiver& receiver, int& failures, Stamp& paused_until) {
    RIGCAL_ASSIGN(const auto next, storage::LoadNextAlert(store, receiver.url, options.clock->Now()));
    if (!next) return false;
    const bool is_shared = !options.place.server.empty();
    const auto claimed =
        is_shared ? storage::ClaimAlert(store, receiver.url, next->alert.number, kClaim) : Result<bool>(true);
    if (!claimed || !*claimed) return claimed.map([](bool) { return true; });  // another server has just taken it
    const Result<int> answer = Post(receiver, next->alert, options.clock->Now(), stopping);
    if (!answer && stopping) return false;
    const bool down = IsDown(answer);
    failures = down ? failures + 1 : 0;
    if (down && failures == 1)
      LogWarn("webhook " + storage::ShownUrl(receiver.url) + " does not take alerts: " + WhyNot(answer) +
              "; they wait");
    RIGCAL_ASSIGN(paused_until, Conclude(store, receiver, *next, answer, failures));
    return !down;
  }

  // The end of the pause, or soon.
  [[nodiscard]] std::chrono::nanoseconds UntilNext(Stamp paused_until) const {
    const std::chrono::nanoseconds pause{paused_until.ns - options.clock->Now().ns};
    if (pause.count() <= 0) return kLookAgain;
    return std::min<std::chrono::nanoseconds>(pause, kLookAgain);
  }

  void Wake() {
    {
      const std::lock_guard lock(mutex);
      ++wakes;
    }
    changed.notify_all();
  }

  Status OpenStores() {
    for (std::size_t i = 0; i < options.receivers.size() + 1; ++i) {
      RIGCAL_ASSIGN(storage::Store store, storage::Store::Open(options.place));
      stores.push_back(std::move(store));
    }
    std::vector<std::string> urls;
    for (const Receiver& one : options.receivers) urls.push_back(one.url);
    return storage::SetReceivers(stores.front(), urls, options.clock->Now());
  }

  void Begin() {
    Vitals& vitals = options.vitals == nullptr ? alone : *options.vitals;
    Part& statuses = vitals.Expect("statuses", kRoundMax);
    threads.emplace_back([this, &statuses] { WatchStatuses(stores.front(), statuses); });
    for (std::size_t i = 0; i < options.receivers.size(); ++i) {
      Part& part = vitals.Expect("webhook " + std::to_string(i + 1), kRoundMax);
      threads.emplace_back([this, i, &part] { SendTo(stores[i + 1], options.receivers[i], part); });
    }
  }

  ~Impl() {
    {
      const std::lock_guard lock(mutex);
      stopping = true;
    }
    changed.notify_all();
    for (std::thread& thread : threads) thread.join();
  }
};

Sender::Sender(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Sender::~Sender() = default;
Sender::Sender(Sender&&) noexcept = default;
Sender& Sender::operator=(Sender&&) noexcept = default;

Result<Sender> Sender::Start(const Options& options) {
  RIGCAL_TRY(CheckAll(options.receivers));
  auto impl = std::make_unique<Impl>();
  impl->options = options;
  RIGCAL_TRY(impl->OpenStores());
  impl->Begin();
  return Sender(std::move(impl));
}

void Sender::Wake() { impl_->Wake(); }

}  // namespace rigcal::webhook
