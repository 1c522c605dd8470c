// What to send next while something is pushed: the client's half of the flow in idl/README.md, as a pure state machine.
// No clock, file or DDS in it: times are nanoseconds of any steady clock and come in from outside.
//
// A session is a list of payloads cut into chunks (`push_chunks.h`). A batch of finished edges is the same with one
// chunk per item and a fixed number of items in flight (BatchPlan).
#pragma once

#include <cstdint>
#include <optional>
#include <set>

#include "client/wire/push_chunks.h"
#include "idl/convert.h"

namespace rigcal::client {

struct PushAction {
  enum class Kind {
    kSendHeader,  // session: SessionHeader; batch: any one item that is not held (ProbeItem)
    kSendManifest,
    kSendChunk,  // `chunk`
    kWait,       // for a receipt, at most until `until_ns`
    kClosed,     // all is durable
    kRefused,    // talk().error says why
    kGaveUp,     // nobody answered for give_up_ns
  };
  Kind kind = Kind::kWait;
  ChunkAt chunk;
  std::int64_t until_ns = 0;
};

// Which receipts are new: of an earlier process of the server, or older than one before, they are not.
class ReceiptOrder {
 public:
  // Nothing in it counts.
  [[nodiscard]] bool IsStale(const wire::Receipt& receipt) const;
  // A receipt that is not stale. True if it is the first of its process.
  [[nodiscard]] bool Take(const wire::Receipt& receipt);
  // Of the server, seen since the first receipt.
  [[nodiscard]] int restarts() const { return static_cast<int>(gone_.size()); }

 private:
  std::optional<std::uint64_t> incarnation_;
  std::set<std::uint64_t> gone_;  // incarnations before this one
  std::uint64_t sequence_number_ = 0;
};

// What the server has said so far.
struct ServerTalk {
  bool answered = false;                                         // by any receipt, ever
  wire::ReceiptState state = wire::ReceiptState::kNeedManifest;  // closed: all is durable
  std::int64_t window_bytes = 0;
  std::optional<Error> complaint;  // what is wrong with a payload while it goes on receiving
  std::optional<Error> error;      // refused, and why
  bool doubted = false;            // one answer that may have been to another question
  int stalls_with_complaint = 0;   // in a row
};

// When things happened; absent: to be done at once.
struct PushTimes {
  std::int64_t heard_ns;     // the last receipt, or the beginning
  std::int64_t progress_ns;  // the server got on, or we sent something
  std::int64_t resume_ns;    // no chunk before
  std::int64_t busy_pause_ns = 0;
  std::optional<std::int64_t> header_ns, manifest_ns;
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
  void NotSent(const ChunkAt& chunk) { chunks_.NotSent(chunk); }
  // The header was not sent, since no server was there to hear it: it is due again at once.
  void NotAsked() { times_.header_ns.reset(); }

  // As they are now.
  [[nodiscard]] const PushChunks& chunks() const { return chunks_; }
  [[nodiscard]] const ServerTalk& talk() const { return talk_; }
  // Since the last receipt, or since the beginning.
  [[nodiscard]] std::int64_t SilentFor(std::int64_t now_ns) const { return now_ns - times_.heard_ns; }
  // Of the server, seen by this engine.
  [[nodiscard]] int restarts() const { return receipts_.restarts(); }

 private:
  [[nodiscard]] bool IsDoubtful(const wire::Receipt& receipt);
  void CheckStall(std::int64_t now_ns);
  [[nodiscard]] std::optional<PushAction> SendPart(std::int64_t now_ns);

  PushPlan plan_;
  PushChunks chunks_;
  ReceiptOrder receipts_;
  ServerTalk talk_;
  PushTimes times_;
};

}  // namespace rigcal::client
