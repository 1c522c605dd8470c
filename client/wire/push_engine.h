// What to send next while something is pushed: the client's half of the flow in idl/README.md, as a pure state machine.
// No clock, file or DDS in it: times are nanoseconds of any steady clock and come in from outside.
//
// A session is a list of payloads cut into chunks. A batch of finished edges is the same with one chunk per item and a
// fixed number of items in flight (BatchPlan).
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <set>
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

struct PushAction {
  enum class Kind {
    kSendHeader,  // session: SessionHeader; batch: any one item that is not held (ProbeItem)
    kSendManifest,
    kSendChunk,  // `chunk`
    kWait,       // for a receipt, at most until `until_ns`
    kClosed,     // all is durable
    kRefused,    // error() says why
    kGaveUp,     // nobody answered for give_up_ns
  };
  Kind kind = Kind::kWait;
  ChunkAt chunk;
  std::int64_t until_ns = 0;
};

class PushEngine {
 public:
  // Nothing is sent yet; silence counts from `now_ns` (steady).
  PushEngine(PushPlan plan, std::int64_t now_ns);

  // A receipt that is older than one before, or comes after the end, is ignored.
  void OnReceipt(const wire::Receipt& receipt, std::int64_t now_ns);
  // Each returned send counts as done; say so if it was not.
  [[nodiscard]] PushAction Next(std::int64_t now_ns);
  // DDS did not take the chunk that Next() gave last: it will be given again.
  void NotSent(const ChunkAt& chunk);
  // The header was not sent, since no server was there to hear it: it is due again at once.
  void NotAsked() { header_ns_.reset(); }
  void Refuse(Error error);

  // All is durable; or refused, or given up, and why.
  [[nodiscard]] bool Closed() const { return state_ == wire::ReceiptState::kClosed; }
  [[nodiscard]] const std::optional<Error>& error() const { return error_; }
  // What the server says is wrong with a payload while it goes on receiving.
  [[nodiscard]] const std::optional<Error>& complaint() const { return complaint_; }

  [[nodiscard]] bool Answered() const { return answered_; }  // by any receipt, ever
  // Since the last receipt, or since the beginning.
  [[nodiscard]] std::int64_t SilentFor(std::int64_t now_ns) const { return now_ns - heard_ns_; }
  [[nodiscard]] int restarts() const { return restarts_; }  // of the server, seen by this engine
  // Of payloads that are durable on the server.
  [[nodiscard]] std::int64_t HeldBytes() const { return held_bytes_; }
  [[nodiscard]] std::int64_t HeldAtFirst() const { return held_at_first_bytes_; }  // before anything was sent
  // Of all payloads of the plan.
  [[nodiscard]] std::int64_t TotalBytes() const { return total_bytes_; }
  // Durable, plus what the server has taken to its disk but not yet receipted: for a bar that moves.
  [[nodiscard]] std::int64_t ArrivedBytes() const;
  [[nodiscard]] std::int64_t InFlightBytes() const;
  [[nodiscard]] bool Held(std::uint32_t payload_idx) const { return held_[payload_idx]; }
  [[nodiscard]] std::size_t PayloadsHeld() const { return payloads_held_; }
  [[nodiscard]] std::uint32_t ProbeItem() const;  // the first payload that is not held (the last one if all are)

 private:
  enum class ChunkState : std::uint8_t { kPending, kSent };

  [[nodiscard]] bool IsStale(const wire::Receipt& receipt) const;
  [[nodiscard]] bool IsDoubtful(const wire::Receipt& receipt);
  void MeetServer(const wire::Receipt& receipt);
  void TakeHeld(const std::vector<bool>& held);
  void TakeBusy(const std::vector<wire::Receipt::ChunkAt>& busy, std::int64_t now_ns);
  void SendAllAgain();
  void Unsend(std::size_t chunk_idx);
  [[nodiscard]] bool IsOnItsWayAgain(std::size_t chunk_idx, std::int64_t now_ns) const;
  [[nodiscard]] std::optional<std::size_t> NextChunk();
  [[nodiscard]] std::int64_t AskAt() const;
  [[nodiscard]] ChunkAt ChunkOf(std::size_t chunk_idx) const;
  [[nodiscard]] std::optional<std::size_t> IndexOf(std::uint32_t payload_idx, std::uint64_t offset_bytes) const;
  [[nodiscard]] std::optional<PushAction> SendPart(std::int64_t now_ns);
  [[nodiscard]] PushAction WaitUntilDue(std::int64_t now_ns) const;
  void MarkSent(std::size_t chunk_idx, std::int64_t now_ns);
  void CheckStall(std::int64_t now_ns);

  PushPlan plan_;
  std::vector<std::size_t> first_chunk_;   // of each payload; one more at the end
  std::vector<std::uint32_t> payload_of_;  // of each chunk
  std::vector<ChunkState> chunks_;
  std::vector<bool> held_;
  std::size_t cursor_ = 0;         // in send_order: all before it were given once
  std::deque<std::size_t> again_;  // to be given again
  std::unordered_map<std::size_t, std::int64_t> given_again_ns_;

  wire::ReceiptState state_ = wire::ReceiptState::kNeedManifest;
  bool answered_ = false, has_sent_ = false, doubted_ = false;
  std::optional<std::uint64_t> incarnation_;
  std::set<std::uint64_t> gone_;  // incarnations before this one
  std::uint64_t sequence_number_ = 0;
  std::int64_t window_bytes_ = 0, written_bytes_ = 0;
  std::int64_t written_base_bytes_ = 0;  // written_bytes when we began to count sent_bytes_
  std::int64_t sent_bytes_ = 0;          // since then, without what was answered busy
  std::int64_t sent_not_held_bytes_ = 0;
  std::int64_t held_bytes_ = 0, held_at_first_bytes_ = 0, total_bytes_ = 0;
  std::size_t payloads_held_ = 0;
  int restarts_ = 0, stalls_with_complaint_ = 0;
  std::optional<Error> error_, complaint_;

  std::int64_t heard_ns_, progress_ns_, resume_ns_;
  std::int64_t busy_pause_ns_ = 0;
  std::optional<std::int64_t> header_ns_, manifest_ns_;
};

}  // namespace rigcal::client
