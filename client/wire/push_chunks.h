// The payloads of a push, cut into chunks: which are to be sent, on their way, or held by the server, and how much of
// the window is taken. No clock, file or DDS in it.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <unordered_map>
#include <vector>

#include "idl/convert.h"
#include "server/base/limits.h"

namespace rigcal::client {

struct PushPlan {
  std::vector<std::int64_t> payload_bytes;  // in the manifest's order
  std::int64_t chunk_bytes = limits::kChunkBytesMax;
  std::optional<std::int64_t> fixed_window_bytes;  // of what is sent and not held; absent: as receipts say
  std::vector<std::uint32_t> send_order;           // of chunks; empty: ascending
  std::int64_t silence_ns = 1'000'000'000;         // after it, ask again
  std::int64_t first_silence_ns = 200'000'000;     // the same before the first answer: endpoints may not be matched
  std::int64_t stall_ns = 5'000'000'000;           // answers without progress: what is in flight counts as lost
  std::int64_t give_up_ns = 60'000'000'000;        // without any answer
};
// One byte per item, at most `in_flight_max` items sent and not held.
[[nodiscard]] PushPlan BatchPlan(std::size_t items, std::size_t in_flight_max);

struct ChunkAt {
  std::uint32_t payload_idx = 0;
  std::uint64_t offset_bytes = 0;
  std::size_t size_bytes = 0;
};

// Where each chunk lies. Chunks are numbered through all payloads.
class ChunkLayout {
 public:
  // Of the plan's payloads.
  explicit ChunkLayout(const PushPlan& plan);

  // Of a chunk or payload that is there.
  [[nodiscard]] ChunkAt At(std::size_t chunk_idx) const;
  [[nodiscard]] std::uint32_t PayloadOf(std::size_t chunk_idx) const { return payload_of_[chunk_idx]; }
  [[nodiscard]] std::int64_t BytesOf(std::size_t payload_idx) const { return payload_bytes_[payload_idx]; }
  // Of a payload: its chunks are first .. one before the next one's. Up to the number of payloads.
  [[nodiscard]] std::size_t FirstOf(std::size_t payload_idx) const { return first_chunk_[payload_idx]; }
  [[nodiscard]] std::size_t chunk_count() const { return payload_of_.size(); }
  // The chunk that holds this byte, if there is one.
  [[nodiscard]] std::optional<std::size_t> IndexOf(std::uint32_t payload_idx, std::uint64_t offset_bytes) const;

 private:
  std::vector<std::int64_t> payload_bytes_;
  std::int64_t chunk_bytes_;
  std::vector<std::size_t> first_chunk_;   // of each payload; one more at the end
  std::vector<std::uint32_t> payload_of_;  // of each chunk
};

// In which order chunks are given: those that came back, then the order of the plan.
class ChunkQueue {
 public:
  // Nothing has been given yet.
  explicit ChunkQueue(const PushPlan& plan) : send_order_(plan.send_order) {}

  // As if nothing had been given.
  void Restart();
  void PutBack(std::size_t chunk_idx) { again_.push_back(chunk_idx); }
  // The next of `count` chunks for which `is_due` holds.
  template <typename IsDue>
  [[nodiscard]] std::optional<std::size_t> Next(std::size_t count, const IsDue& is_due) {
    while (!again_.empty() && !is_due(again_.front())) again_.pop_front();
    if (!again_.empty()) return again_.front();
    for (; cursor_ < count; ++cursor_) {
      const std::size_t idx = send_order_.empty() ? cursor_ : send_order_[cursor_];
      if (is_due(idx)) return idx;
    }
    return std::nullopt;
  }
  // What Next gave is sent.
  void Take(std::size_t chunk_idx, std::int64_t now_ns);
  // A chunk stays listed as busy until the server has it: receipts that were written meanwhile must not make it travel
  // thrice.
  [[nodiscard]] bool IsOnItsWayAgain(std::size_t chunk_idx, std::int64_t now_ns) const;

 private:
  std::vector<std::uint32_t> send_order_;
  std::size_t cursor_ = 0;         // in send_order: all before it were given once
  std::deque<std::size_t> again_;  // to be given again
  std::unordered_map<std::size_t, std::int64_t> given_again_ns_;
};

struct PushCounts {
  std::int64_t total_bytes = 0;          // of all payloads of the plan
  std::int64_t held_bytes = 0;           // of payloads that are durable on the server
  std::int64_t held_at_first_bytes = 0;  // the same before anything was sent
  std::size_t payloads_held = 0;
  std::int64_t written_bytes = 0;       // by the server, as receipts say
  std::int64_t written_base_bytes = 0;  // the same when we began to count sent_bytes
  std::int64_t sent_bytes = 0;          // since then, without what was answered busy
  std::int64_t sent_not_held_bytes = 0;
};

class PushChunks {
 public:
  // Nothing is sent or held yet.
  explicit PushChunks(const PushPlan& plan);

  // Another server: what was in flight is lost, and what it holds is what it will say.
  void Restart(const wire::Receipt& receipt);
  // What the server holds and has written.
  void TakeHeld(const wire::Receipt& receipt);
  // Chunks that the server could not take are to be sent again. False if none of ours in flight is among them: another
  // client may push the same session.
  [[nodiscard]] bool TakeBusy(const std::vector<wire::Receipt::ChunkAt>& busy, std::int64_t now_ns);
  // All that is in flight counts as lost.
  void SendAllAgain();
  // This chunk was not sent after all: it will be given again.
  void NotSent(const ChunkAt& chunk);
  // The next chunk, which counts as sent; none if all are, or the window (the plan's, else this one) is taken.
  [[nodiscard]] std::optional<ChunkAt> Next(std::int64_t window_bytes, std::int64_t now_ns);

  // As they are now.
  [[nodiscard]] const PushCounts& counts() const { return counts_; }
  // By payload: durable on the server.
  [[nodiscard]] const std::vector<bool>& held() const { return held_; }
  // Durable, plus what the server has taken to its disk but not yet receipted: for a bar that moves.
  [[nodiscard]] std::int64_t ArrivedBytes() const;
  [[nodiscard]] std::int64_t InFlightBytes() const;

 private:
  void Unsend(std::size_t chunk_idx);

  ChunkLayout layout_;
  ChunkQueue queue_;
  std::optional<std::int64_t> fixed_window_bytes_;
  std::vector<bool> sent_;  // by chunk: given, and not to be given again
  std::vector<bool> held_;
  PushCounts counts_;
  bool has_sent_ = false;  // ever
};

// The first payload that is not held (the last one if all are).
[[nodiscard]] std::uint32_t ProbeItem(const PushChunks& chunks);

}  // namespace rigcal::client
