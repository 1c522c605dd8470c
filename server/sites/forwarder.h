// Sends on to the centre what robots pushed here (storage/sites/forward_queue.h), in the order in which it became
// whole. Owns one thread with a Store of its own: a centre that is away holds up nothing else.
#pragma once

#include <cstdint>
#include <memory>

#include "server/base/process/vitals.h"
#include "server/base/stamp.h"
#include "server/sites/take_over.h"
#include "storage/store_place.h"

namespace rigcal::sites {

// After so many failures one after the other, counted from 1: a second, then twice as long each time, a minute at most.
[[nodiscard]] std::int64_t LinkRetryAfter_ns(int failures);

class Forwarder {
 public:
  struct Options {
    storage::StorePlace place;
    const Clock* clock = nullptr;
    CentreAddress centre;
    Vitals* vitals = nullptr;
    GivesOrder give = {};  // take_over.h; none: nothing is taken over from the centre
  };
  // Begins at once. The error says what is wrong with the address, or why the store cannot be opened. An empty address:
  // nothing is sent, and nothing waits from now on; in a store that servers share what waits for another's centre
  // stays.
  [[nodiscard]] static Result<Forwarder> Start(const Options& options);
  ~Forwarder();  // breaks off what is under way: it is sent again
  // One that was moved from does nothing: the other goes on.
  Forwarder(Forwarder&&) noexcept;
  Forwarder& operator=(Forwarder&&) noexcept;
  // Something may wait. Any thread, never blocks.
  void Wake();

 private:
  struct Impl;
  explicit Forwarder(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rigcal::sites
