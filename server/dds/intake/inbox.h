// The queue between threads D and Q, which never wait, and thread W. Bounded in bytes: per session and in all.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "server/dds/intake/arrival.h"

namespace rigcal::dds {

class Inbox {
 public:
  struct Limits {
    std::int64_t session_bytes, all_bytes;
    std::size_t items;
  };
  // `session_bytes`: of what waits of one session; `all_bytes` and `items`: of all that waits.
  explicit Inbox(const Limits& limits) : limits_(limits) {}

  // Never waits. A chunk beyond the limits becomes a DiscardedChunk; anything else beyond them is dropped, as clients
  // repeat what is not answered. False if the arrival was discarded or dropped.
  bool Offer(Arrival arrival);
  // Waits until there is room for it, at most so long; false, and nothing is put there, where there is none or this was
  // stopped.
  bool OfferWithin(Arrival arrival, std::chrono::milliseconds timeout);
  // About `bytes_max` bytes of arrivals in order, orders first, or fewer; waits for the first or for Wake. What it gave
  // counts against the limits until Release.
  [[nodiscard]] std::vector<Arrival> Take(std::int64_t bytes_max, std::chrono::milliseconds timeout);
  void Release();
  [[nodiscard]] bool Empty() const;
  // What counts against the limits now.
  struct Load {
    std::int64_t bytes = 0, bytes_max = 0;
    std::size_t arrivals = 0;
  };
  [[nodiscard]] Load Look() const;
  void Wake();  // ends a Take
  void Stop();
  [[nodiscard]] bool Stopped() const;

 private:
  // Call these with mutex_.
  [[nodiscard]] bool Fits(std::int64_t bytes, std::int64_t session_bytes) const;
  [[nodiscard]] bool HasRoomFor(const Arrival& arrival) const;
  void Put(Arrival arrival, std::int64_t bytes);
  void PutCounted(Arrival arrival);
  [[nodiscard]] Status MoveFirstTo(std::vector<Arrival>& taken);

  struct Bytes {
    std::int64_t all = 0;
    std::unordered_map<SessionId, std::int64_t> of_chunks;
  };

  const Limits limits_;
  mutable std::mutex mutex_;
  std::condition_variable filled_, emptied_;
  std::deque<Arrival> queue_;
  Bytes counted_, taken_;  // against the limits; of them what Take gave and Release has not given back
  bool woken_ = false, stopped_ = false;
};

}  // namespace rigcal::dds
