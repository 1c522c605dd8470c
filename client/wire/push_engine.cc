#include "client/wire/push_engine.h"

#include <algorithm>

namespace rigcal::client {
namespace {

constexpr std::int64_t kBusyPauseFirst_ns = 5'000'000;
constexpr std::int64_t kBusyPauseMax_ns = 500'000'000;
constexpr std::int64_t kOnItsWay_ns = 500'000'000;
// A manifest may be 16 MB on a slow link: it is not sent at every "need_manifest".
constexpr std::int64_t kManifestAgain_ns = 3'000'000'000;
constexpr int kComplaintsMax = 2;

}  // namespace

PushPlan BatchPlan(std::size_t items, std::size_t in_flight_max) {
  PushPlan plan;
  plan.payload_bytes.assign(items, 1);
  plan.chunk_bytes = 1;
  plan.fixed_window_bytes = static_cast<std::int64_t>(in_flight_max);
  return plan;
}

PushEngine::PushEngine(PushPlan plan, std::int64_t now_ns)
    : plan_(std::move(plan)),
      held_(plan_.payload_bytes.size(), false),
      heard_ns_(now_ns),
      progress_ns_(now_ns),
      resume_ns_(now_ns) {
  for (std::size_t i = 0; i < plan_.payload_bytes.size(); ++i) {
    first_chunk_.push_back(payload_of_.size());
    const std::int64_t size_bytes = plan_.payload_bytes[i];
    const auto count = static_cast<std::size_t>((size_bytes + plan_.chunk_bytes - 1) / plan_.chunk_bytes);
    payload_of_.insert(payload_of_.end(), count, static_cast<std::uint32_t>(i));
    total_bytes_ += size_bytes;
  }
  first_chunk_.push_back(payload_of_.size());
  chunks_.assign(payload_of_.size(), ChunkState::kPending);
}

ChunkAt PushEngine::ChunkOf(std::size_t chunk_idx) const {
  const std::uint32_t payload = payload_of_[chunk_idx];
  const std::int64_t offset_bytes = static_cast<std::int64_t>(chunk_idx - first_chunk_[payload]) * plan_.chunk_bytes;
  const std::int64_t size_bytes = std::min(plan_.chunk_bytes, plan_.payload_bytes[payload] - offset_bytes);
  return {payload, static_cast<std::uint64_t>(offset_bytes), static_cast<std::size_t>(size_bytes)};
}

std::optional<std::size_t> PushEngine::IndexOf(std::uint32_t payload_idx, std::uint64_t offset_bytes) const {
  if (payload_idx >= held_.size()) return std::nullopt;
  const std::size_t idx = first_chunk_[payload_idx] + offset_bytes / static_cast<std::uint64_t>(plan_.chunk_bytes);
  if (idx >= first_chunk_[payload_idx + 1]) return std::nullopt;
  return idx;
}

std::int64_t PushEngine::InFlightBytes() const {
  if (plan_.fixed_window_bytes) return sent_not_held_bytes_;
  // A held payload has nothing in flight, whatever the server counted twice or not at all.
  return std::clamp<std::int64_t>(sent_bytes_ - (written_bytes_ - written_base_bytes_), 0, sent_not_held_bytes_);
}

std::int64_t PushEngine::ArrivedBytes() const {
  if (plan_.fixed_window_bytes) return held_bytes_;
  return std::min(total_bytes_, held_bytes_ + sent_not_held_bytes_ - InFlightBytes());
}

std::uint32_t PushEngine::ProbeItem() const {
  const auto found = std::find(held_.begin(), held_.end(), false);
  const auto idx = static_cast<std::uint32_t>(found - held_.begin());
  return found == held_.end() && idx > 0 ? idx - 1 : idx;
}

bool PushEngine::IsStale(const wire::Receipt& receipt) const {
  if (gone_.count(receipt.incarnation) > 0) return true;
  return incarnation_ == receipt.incarnation && receipt.sequence_number <= sequence_number_;
}

// The newest receipt comes to those who join late: a refusal may be that of an earlier try, whose cause is mended, and
// `closed`, of a session, that of an earlier push, after which another one superseded it. The answer to our own
// question is believed.
bool PushEngine::IsDoubtful(const wire::Receipt& receipt) {
  const bool is_closed = receipt.state == wire::ReceiptState::kClosed && !plan_.fixed_window_bytes;
  if ((receipt.state != wire::ReceiptState::kRefused && !is_closed) || answered_ || doubted_) return false;
  if (is_closed) header_ns_.reset();  // asked at once
  return doubted_ = true;
}

void PushEngine::OnReceipt(const wire::Receipt& receipt, std::int64_t now_ns) {
  if (Closed() || error_ || IsStale(receipt)) return;
  heard_ns_ = now_ns;
  if (incarnation_ != receipt.incarnation) MeetServer(receipt);
  sequence_number_ = receipt.sequence_number;
  if (IsDoubtful(receipt)) return;
  const auto before = std::pair(payloads_held_, written_bytes_);
  const bool state_changed = !answered_ || state_ != receipt.state;
  answered_ = true;
  state_ = receipt.state;
  window_bytes_ = static_cast<std::int64_t>(receipt.window_bytes);
  written_bytes_ = static_cast<std::int64_t>(receipt.written_bytes);
  TakeHeld(receipt.held);
  if (!has_sent_) held_at_first_bytes_ = held_bytes_;
  if (before.first != payloads_held_) stalls_with_complaint_ = 0;
  if (before != std::pair(payloads_held_, written_bytes_) || state_changed) {
    progress_ns_ = now_ns;
    busy_pause_ns_ = 0;
  }
  TakeBusy(receipt.busy, now_ns);
  complaint_ = state_ == wire::ReceiptState::kReceiving ? receipt.error : std::nullopt;
  if (state_ == wire::ReceiptState::kRefused)
    error_ = receipt.error.value_or(
        Error{ErrorCode::kInvalidInput, "the server refused it without saying why", "Look at the server's log"});
}

// Another incarnation: what was in flight is lost, and its held bits are the truth.
void PushEngine::MeetServer(const wire::Receipt& receipt) {
  if (incarnation_) {
    gone_.insert(*incarnation_);
    ++restarts_;
  }
  incarnation_ = receipt.incarnation;
  sequence_number_ = 0;
  manifest_ns_.reset();
  held_.assign(held_.size(), false);
  held_bytes_ = 0;
  payloads_held_ = 0;
  written_bytes_ = static_cast<std::int64_t>(receipt.written_bytes);
  chunks_.assign(chunks_.size(), ChunkState::kPending);
  cursor_ = 0;
  again_.clear();
  given_again_ns_.clear();
  sent_bytes_ = sent_not_held_bytes_ = 0;
  written_base_bytes_ = written_bytes_;
}

void PushEngine::TakeHeld(const std::vector<bool>& held) {
  const std::size_t count = std::min(held.size(), held_.size());
  for (std::size_t i = 0; i < count; ++i) {
    if (!held[i] || held_[i]) continue;
    held_[i] = true;
    ++payloads_held_;
    held_bytes_ += plan_.payload_bytes[i];
    for (std::size_t chunk = first_chunk_[i]; chunk < first_chunk_[i + 1]; ++chunk)
      if (chunks_[chunk] == ChunkState::kSent)
        sent_not_held_bytes_ -= static_cast<std::int64_t>(ChunkOf(chunk).size_bytes);
  }
}

void PushEngine::Unsend(std::size_t chunk_idx) {
  const auto size_bytes = static_cast<std::int64_t>(ChunkOf(chunk_idx).size_bytes);
  chunks_[chunk_idx] = ChunkState::kPending;
  sent_bytes_ -= size_bytes;
  sent_not_held_bytes_ -= size_bytes;
  again_.push_back(chunk_idx);
}

// A chunk stays listed until the server has it: receipts that were written meanwhile must not make it travel thrice.
bool PushEngine::IsOnItsWayAgain(std::size_t chunk_idx, std::int64_t now_ns) const {
  const auto given = given_again_ns_.find(chunk_idx);
  return given != given_again_ns_.end() && now_ns - given->second < kOnItsWay_ns;
}

// The list may name chunks of another client that pushes the same session: only ours in flight count.
void PushEngine::TakeBusy(const std::vector<wire::Receipt::ChunkAt>& busy, std::int64_t now_ns) {
  bool any = false;
  for (const auto& item : busy) {
    const auto idx = IndexOf(item.payload_idx, item.offset_bytes);
    if (!idx || held_[item.payload_idx] || chunks_[*idx] != ChunkState::kSent) continue;
    if (IsOnItsWayAgain(*idx, now_ns)) continue;
    Unsend(*idx);
    any = true;
  }
  if (!any) return;
  busy_pause_ns_ = std::clamp(2 * busy_pause_ns_, kBusyPauseFirst_ns, kBusyPauseMax_ns);
  resume_ns_ = now_ns + busy_pause_ns_;
}

void PushEngine::SendAllAgain() {
  for (std::size_t i = 0; i < chunks_.size(); ++i)
    if (chunks_[i] == ChunkState::kSent && !held_[payload_of_[i]]) Unsend(i);
  sent_bytes_ = sent_not_held_bytes_ = 0;
  written_base_bytes_ = written_bytes_;
}

void PushEngine::NotSent(const ChunkAt& chunk) {
  const auto idx = IndexOf(chunk.payload_idx, chunk.offset_bytes);
  if (idx && chunks_[*idx] == ChunkState::kSent && !held_[chunk.payload_idx]) Unsend(*idx);
}

void PushEngine::Refuse(Error error) {
  if (!Closed() && !error_) error_ = std::move(error);
}

std::optional<std::size_t> PushEngine::NextChunk() {
  const auto is_due = [&](std::size_t idx) { return chunks_[idx] == ChunkState::kPending && !held_[payload_of_[idx]]; };
  while (!again_.empty() && !is_due(again_.front())) again_.pop_front();
  if (!again_.empty()) return again_.front();
  for (; cursor_ < chunks_.size(); ++cursor_) {
    const std::size_t idx = plan_.send_order.empty() ? cursor_ : plan_.send_order[cursor_];
    if (is_due(idx)) return idx;
  }
  return std::nullopt;
}

void PushEngine::MarkSent(std::size_t chunk_idx, std::int64_t now_ns) {
  const auto size_bytes = static_cast<std::int64_t>(ChunkOf(chunk_idx).size_bytes);
  chunks_[chunk_idx] = ChunkState::kSent;
  has_sent_ = true;
  if (!again_.empty() && again_.front() == chunk_idx) {
    again_.pop_front();
    given_again_ns_[chunk_idx] = now_ns;
  }
  sent_bytes_ += size_bytes;
  sent_not_held_bytes_ += size_bytes;
  progress_ns_ = now_ns;
}

// The server answers, yet nothing that we sent shows: it never reached it (an endpoint was not yet matched).
void PushEngine::CheckStall(std::int64_t now_ns) {
  if (state_ != wire::ReceiptState::kReceiving || sent_not_held_bytes_ == 0) return;
  if (now_ns - progress_ns_ < plan_.stall_ns || now_ns - heard_ns_ >= 2 * plan_.silence_ns) return;
  if (complaint_ && ++stalls_with_complaint_ >= kComplaintsMax) return Refuse(*complaint_);
  SendAllAgain();
  progress_ns_ = now_ns;
}

std::optional<PushAction> PushEngine::SendPart(std::int64_t now_ns) {
  if (state_ == wire::ReceiptState::kNeedManifest) {
    if (!answered_ || (manifest_ns_ && now_ns - *manifest_ns_ < kManifestAgain_ns)) return std::nullopt;
    manifest_ns_ = now_ns;
    return PushAction{PushAction::Kind::kSendManifest, {}, 0};
  }
  const bool may_send = state_ == wire::ReceiptState::kReceiving && now_ns >= resume_ns_;
  const auto idx = may_send ? NextChunk() : std::nullopt;
  if (!idx) return std::nullopt;
  const ChunkAt chunk = ChunkOf(*idx);
  const std::int64_t window_bytes = plan_.fixed_window_bytes.value_or(window_bytes_);
  if (InFlightBytes() + static_cast<std::int64_t>(chunk.size_bytes) > window_bytes) return std::nullopt;
  MarkSent(*idx, now_ns);
  return PushAction{PushAction::Kind::kSendChunk, chunk, 0};
}

PushAction PushEngine::Next(std::int64_t now_ns) {
  if (!error_) CheckStall(now_ns);
  if (error_) return {PushAction::Kind::kRefused, {}, 0};
  if (Closed()) return {PushAction::Kind::kClosed, {}, 0};
  if (SilentFor(now_ns) >= plan_.give_up_ns) return {PushAction::Kind::kGaveUp, {}, 0};
  if (!header_ns_ || now_ns >= AskAt()) {
    header_ns_ = now_ns;
    return {PushAction::Kind::kSendHeader, {}, 0};
  }
  if (auto action = SendPart(now_ns)) return *action;
  return WaitUntilDue(now_ns);
}

std::int64_t PushEngine::AskAt() const {
  return std::max(heard_ns_, *header_ns_) + (answered_ ? plan_.silence_ns : plan_.first_silence_ns);
}

PushAction PushEngine::WaitUntilDue(std::int64_t now_ns) const {
  std::int64_t until_ns = std::min(AskAt(), heard_ns_ + plan_.give_up_ns);
  if (resume_ns_ > now_ns) until_ns = std::min(until_ns, resume_ns_);
  return {PushAction::Kind::kWait, {}, std::max(until_ns, now_ns + 1)};
}

}  // namespace rigcal::client
