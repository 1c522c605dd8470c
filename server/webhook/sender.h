// Sends what waits in the outbox (storage/alerts/outbox.h), and notes statuses that change with the time. Owns a thread
// for the statuses and one per receiver, each with a Store of its own: a receiver that is down blocks nothing else.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "server/base/process/vitals.h"
#include "server/webhook/post.h"
#include "storage/store_place.h"

namespace rigcal::webhook {

// After so many attempts in vain, counted from 1, it is tried again after this long: a second, then twice as long each
// time, up to a day. It is never given up.
[[nodiscard]] std::int64_t RetryAfter_ns(int attempts);

class Sender {
 public:
  struct Options {
    storage::StorePlace place;
    const Clock* clock = nullptr;
    std::vector<Receiver> receivers;  // none: statuses are noted all the same
    Vitals* vitals = nullptr;
  };
  // kInvalidInput: CheckReceiver, or an address twice. Receivers that are not among these are told of nothing from now
  // on.
  [[nodiscard]] static Result<Sender> Start(const Options& options);
  ~Sender();  // breaks off what is being sent: it goes out again after the next start
  Sender(Sender&&) noexcept;
  Sender& operator=(Sender&&) noexcept;
  // Something may wait. Any thread; never blocks.
  void Wake();

 private:
  struct Impl;
  explicit Sender(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rigcal::webhook
