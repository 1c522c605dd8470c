#include "client/wire/push_engine.h"

#include <algorithm>
#include <utility>

namespace rigcal::client {
namespace {

constexpr std::int64_t kBusyPauseFirst_ns = 5'000'000;
constexpr std::int64_t kBusyPauseMax_ns = 500'000'000;
// A manifest may be 16 MB on a slow link: it is not sent at every "need_manifest".
constexpr std::int64_t kManifestAgain_ns = 3'000'000'000;
constexpr int kComplaintsMax = 2;

// When the question is due again that was asked at times.header_ns.
std::int64_t AskAt(const PushTimes& times, const PushPlan& plan, bool answered) {
  return std::max(times.heard_ns, *times.header_ns) + (answered ? plan.silence_ns : plan.first_silence_ns);
}

PushAction WaitUntilDue(const PushTimes& times, const PushPlan& plan, bool answered, std::int64_t now_ns) {
  std::int64_t until_ns = std::min(AskAt(times, plan, answered), times.heard_ns + plan.give_up_ns);
  if (times.resume_ns > now_ns) until_ns = std::min(until_ns, times.resume_ns);
  return {PushAction::Kind::kWait, {}, std::max(until_ns, now_ns + 1)};
}

// Twice as long as before, if the server got on with nothing since.
void Pause(PushTimes& times, std::int64_t now_ns) {
  times.busy_pause_ns = std::clamp(2 * times.busy_pause_ns, kBusyPauseFirst_ns, kBusyPauseMax_ns);
  times.resume_ns = now_ns + times.busy_pause_ns;
}

}  // namespace

bool ReceiptOrder::IsStale(const wire::Receipt& receipt) const {
  if (gone_.count(receipt.incarnation) > 0) return true;
  return incarnation_ == receipt.incarnation && receipt.sequence_number <= sequence_number_;
}

bool ReceiptOrder::Take(const wire::Receipt& receipt) {
  sequence_number_ = receipt.sequence_number;
  if (incarnation_ == receipt.incarnation) return false;
  if (incarnation_) gone_.insert(*incarnation_);
  incarnation_ = receipt.incarnation;
  return true;
}

PushEngine::PushEngine(PushPlan plan, std::int64_t now_ns)
    : plan_(std::move(plan)), chunks_(plan_), times_{now_ns, now_ns, now_ns, 0, {}, {}} {}

// The newest receipt comes to those who join late: a refusal may be that of an earlier try, whose cause is mended, and
// `closed`, of a session, that of an earlier push, after which another one superseded it. The answer to our own
// question is believed.
bool PushEngine::IsDoubtful(const wire::Receipt& receipt) {
  const bool is_closed = receipt.state == wire::ReceiptState::kClosed && !plan_.fixed_window_bytes;
  if ((receipt.state != wire::ReceiptState::kRefused && !is_closed) || talk_.answered || talk_.doubted) return false;
  if (is_closed) times_.header_ns.reset();  // asked at once
  return talk_.doubted = true;
}

void PushEngine::OnReceipt(const wire::Receipt& receipt, std::int64_t now_ns) {
  if (talk_.state == wire::ReceiptState::kClosed || talk_.error || receipts_.IsStale(receipt)) return;
  times_.heard_ns = now_ns;
  if (receipts_.Take(receipt)) {
    chunks_.Restart(receipt);
    times_.manifest_ns.reset();
  }
  if (IsDoubtful(receipt)) return;
  const PushCounts before = chunks_.counts();
  const bool state_changed = !talk_.answered || talk_.state != receipt.state;
  talk_.answered = true;
  talk_.state = receipt.state;
  talk_.window_bytes = static_cast<std::int64_t>(receipt.window_bytes);
  chunks_.TakeHeld(receipt);
  const bool holds_more = chunks_.counts().payloads_held != before.payloads_held;
  if (holds_more) talk_.stalls_with_complaint = 0;
  if (holds_more || chunks_.counts().written_bytes != before.written_bytes || state_changed) {
    times_.progress_ns = now_ns;
    times_.busy_pause_ns = 0;
  }
  if (chunks_.TakeBusy(receipt.busy, now_ns)) Pause(times_, now_ns);
  talk_.complaint = talk_.state == wire::ReceiptState::kReceiving ? receipt.error : std::nullopt;
  if (talk_.state == wire::ReceiptState::kRefused)
    talk_.error = receipt.error.value_or(
        Error{ErrorCode::kInvalidInput, "the server refused it without saying why", "Look at the server's log"});
}

// The server answers, yet nothing that we sent shows: it never reached it (an endpoint was not yet matched).
void PushEngine::CheckStall(std::int64_t now_ns) {
  if (talk_.state != wire::ReceiptState::kReceiving || chunks_.counts().sent_not_held_bytes == 0) return;
  if (now_ns - times_.progress_ns < plan_.stall_ns || SilentFor(now_ns) >= 2 * plan_.silence_ns) return;
  if (talk_.complaint && ++talk_.stalls_with_complaint >= kComplaintsMax) {
    talk_.error = talk_.complaint;
    return;
  }
  chunks_.SendAllAgain();
  times_.progress_ns = now_ns;
}

std::optional<PushAction> PushEngine::SendPart(std::int64_t now_ns) {
  if (talk_.state == wire::ReceiptState::kNeedManifest) {
    if (!talk_.answered || (times_.manifest_ns && now_ns - *times_.manifest_ns < kManifestAgain_ns))
      return std::nullopt;
    times_.manifest_ns = now_ns;
    return PushAction{PushAction::Kind::kSendManifest, {}, 0};
  }
  const bool may_send = talk_.state == wire::ReceiptState::kReceiving && now_ns >= times_.resume_ns;
  const auto chunk = may_send ? chunks_.Next(talk_.window_bytes, now_ns) : std::nullopt;
  if (!chunk) return std::nullopt;
  times_.progress_ns = now_ns;
  return PushAction{PushAction::Kind::kSendChunk, *chunk, 0};
}

PushAction PushEngine::Next(std::int64_t now_ns) {
  if (!talk_.error) CheckStall(now_ns);
  if (talk_.error) return {PushAction::Kind::kRefused, {}, 0};
  if (talk_.state == wire::ReceiptState::kClosed) return {PushAction::Kind::kClosed, {}, 0};
  if (SilentFor(now_ns) >= plan_.give_up_ns) return {PushAction::Kind::kGaveUp, {}, 0};
  if (!times_.header_ns || now_ns >= AskAt(times_, plan_, talk_.answered)) {
    times_.header_ns = now_ns;
    return {PushAction::Kind::kSendHeader, {}, 0};
  }
  if (auto action = SendPart(now_ns)) return *action;
  return WaitUntilDue(times_, plan_, talk_.answered, now_ns);
}

}  // namespace rigcal::client
