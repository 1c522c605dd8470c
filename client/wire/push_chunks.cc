#include "client/wire/push_chunks.h"

#include <algorithm>
#include <numeric>

namespace rigcal::client {
namespace {

constexpr std::int64_t kOnItsWay_ns = 500'000'000;

}  // namespace

PushPlan BatchPlan(std::size_t items, std::size_t in_flight_max) {
  PushPlan plan;
  plan.payload_bytes.assign(items, 1);
  plan.chunk_bytes = 1;
  plan.fixed_window_bytes = static_cast<std::int64_t>(in_flight_max);
  return plan;
}

ChunkLayout::ChunkLayout(const PushPlan& plan) : payload_bytes_(plan.payload_bytes), chunk_bytes_(plan.chunk_bytes) {
  for (std::size_t i = 0; i < payload_bytes_.size(); ++i) {
    first_chunk_.push_back(payload_of_.size());
    const auto count = static_cast<std::size_t>((payload_bytes_[i] + chunk_bytes_ - 1) / chunk_bytes_);
    payload_of_.insert(payload_of_.end(), count, static_cast<std::uint32_t>(i));
  }
  first_chunk_.push_back(payload_of_.size());
}

ChunkAt ChunkLayout::At(std::size_t chunk_idx) const {
  const std::uint32_t payload = payload_of_[chunk_idx];
  const std::int64_t offset_bytes = static_cast<std::int64_t>(chunk_idx - first_chunk_[payload]) * chunk_bytes_;
  const std::int64_t size_bytes = std::min(chunk_bytes_, payload_bytes_[payload] - offset_bytes);
  return {payload, static_cast<std::uint64_t>(offset_bytes), static_cast<std::size_t>(size_bytes)};
}

std::optional<std::size_t> ChunkLayout::IndexOf(std::uint32_t payload_idx, std::uint64_t offset_bytes) const {
  if (payload_idx >= payload_bytes_.size()) return std::nullopt;
  const std::size_t idx = first_chunk_[payload_idx] + offset_bytes / static_cast<std::uint64_t>(chunk_bytes_);
  if (idx >= first_chunk_[payload_idx + 1]) return std::nullopt;
  return idx;
}

void ChunkQueue::Restart() {
  cursor_ = 0;
  again_.clear();
  given_again_ns_.clear();
}

void ChunkQueue::Take(std::size_t chunk_idx, std::int64_t now_ns) {
  if (again_.empty() || again_.front() != chunk_idx) return;
  again_.pop_front();
  given_again_ns_[chunk_idx] = now_ns;
}

bool ChunkQueue::IsOnItsWayAgain(std::size_t chunk_idx, std::int64_t now_ns) const {
  const auto given = given_again_ns_.find(chunk_idx);
  return given != given_again_ns_.end() && now_ns - given->second < kOnItsWay_ns;
}

PushChunks::PushChunks(const PushPlan& plan)
    : layout_(plan),
      queue_(plan),
      fixed_window_bytes_(plan.fixed_window_bytes),
      sent_(layout_.chunk_count(), false),
      held_(plan.payload_bytes.size(), false) {
  counts_.total_bytes = std::accumulate(plan.payload_bytes.begin(), plan.payload_bytes.end(), std::int64_t{0});
}

void PushChunks::Restart(const wire::Receipt& receipt) {
  held_.assign(held_.size(), false);
  sent_.assign(sent_.size(), false);
  queue_.Restart();
  counts_.held_bytes = 0;
  counts_.payloads_held = 0;
  counts_.sent_bytes = counts_.sent_not_held_bytes = 0;
  counts_.written_bytes = counts_.written_base_bytes = static_cast<std::int64_t>(receipt.written_bytes);
}

void PushChunks::TakeHeld(const wire::Receipt& receipt) {
  counts_.written_bytes = static_cast<std::int64_t>(receipt.written_bytes);
  const std::size_t count = std::min(receipt.held.size(), held_.size());
  for (std::size_t i = 0; i < count; ++i) {
    if (!receipt.held[i] || held_[i]) continue;
    held_[i] = true;
    ++counts_.payloads_held;
    counts_.held_bytes += layout_.BytesOf(i);
    for (std::size_t chunk = layout_.FirstOf(i); chunk < layout_.FirstOf(i + 1); ++chunk)
      if (sent_[chunk]) counts_.sent_not_held_bytes -= static_cast<std::int64_t>(layout_.At(chunk).size_bytes);
  }
  if (!has_sent_) counts_.held_at_first_bytes = counts_.held_bytes;
}

bool PushChunks::TakeBusy(const std::vector<wire::Receipt::ChunkAt>& busy, std::int64_t now_ns) {
  bool any = false;
  for (const auto& item : busy) {
    const auto idx = layout_.IndexOf(item.payload_idx, item.offset_bytes);
    if (!idx || held_[item.payload_idx] || !sent_[*idx]) continue;
    if (queue_.IsOnItsWayAgain(*idx, now_ns)) continue;
    Unsend(*idx);
    any = true;
  }
  return any;
}

void PushChunks::SendAllAgain() {
  for (std::size_t i = 0; i < sent_.size(); ++i)
    if (sent_[i] && !held_[layout_.PayloadOf(i)]) Unsend(i);
  counts_.sent_bytes = counts_.sent_not_held_bytes = 0;
  counts_.written_base_bytes = counts_.written_bytes;
}

void PushChunks::NotSent(const ChunkAt& chunk) {
  const auto idx = layout_.IndexOf(chunk.payload_idx, chunk.offset_bytes);
  if (idx && sent_[*idx] && !held_[chunk.payload_idx]) Unsend(*idx);
}

void PushChunks::Unsend(std::size_t chunk_idx) {
  const auto size_bytes = static_cast<std::int64_t>(layout_.At(chunk_idx).size_bytes);
  sent_[chunk_idx] = false;
  counts_.sent_bytes -= size_bytes;
  counts_.sent_not_held_bytes -= size_bytes;
  queue_.PutBack(chunk_idx);
}

std::optional<ChunkAt> PushChunks::Next(std::int64_t window_bytes, std::int64_t now_ns) {
  const auto idx = queue_.Next(sent_.size(),
                               [this](std::size_t chunk) { return !sent_[chunk] && !held_[layout_.PayloadOf(chunk)]; });
  if (!idx) return std::nullopt;
  const ChunkAt chunk = layout_.At(*idx);
  const auto size_bytes = static_cast<std::int64_t>(chunk.size_bytes);
  if (InFlightBytes() + size_bytes > fixed_window_bytes_.value_or(window_bytes)) return std::nullopt;
  sent_[*idx] = true;
  has_sent_ = true;
  queue_.Take(*idx, now_ns);
  counts_.sent_bytes += size_bytes;
  counts_.sent_not_held_bytes += size_bytes;
  return chunk;
}

std::int64_t PushChunks::InFlightBytes() const {
  if (fixed_window_bytes_) return counts_.sent_not_held_bytes;
  // A held payload has nothing in flight, whatever the server counted twice or not at all.
  const std::int64_t unwritten_bytes = counts_.sent_bytes - (counts_.written_bytes - counts_.written_base_bytes);
  return std::clamp<std::int64_t>(unwritten_bytes, 0, counts_.sent_not_held_bytes);
}

std::int64_t PushChunks::ArrivedBytes() const {
  if (fixed_window_bytes_) return counts_.held_bytes;
  return std::min(counts_.total_bytes, counts_.held_bytes + counts_.sent_not_held_bytes - InFlightBytes());
}

std::uint32_t ProbeItem(const PushChunks& chunks) {
  const std::vector<bool>& held = chunks.held();
  const auto found = std::find(held.begin(), held.end(), false);
  const auto idx = static_cast<std::uint32_t>(found - held.begin());
  return found == held.end() && idx > 0 ? idx - 1 : idx;
}

}  // namespace rigcal::client
