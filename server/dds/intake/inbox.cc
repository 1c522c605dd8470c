#include "server/dds/intake/inbox.h"

namespace rigcal::dds {

bool Inbox::Fits(const Arrival& arrival, std::int64_t bytes) {
  if (all_bytes_ + bytes > limits_.all_bytes || queue_.size() >= limits_.items) return false;
  const auto* chunk = std::get_if<ChunkBytes>(&arrival);
  if (chunk == nullptr) return true;
  const auto size_bytes = static_cast<std::int64_t>(chunk->bytes.size());
  const auto found = session_bytes_.find(chunk->session);
  const std::int64_t queued_bytes = found == session_bytes_.end() ? 0 : found->second;
  if (queued_bytes + size_bytes > limits_.session_bytes) return false;
  session_bytes_[chunk->session] = queued_bytes + size_bytes;
  return true;
}

bool Inbox::Offer(Arrival arrival) {
  const std::int64_t bytes = BytesOf(arrival);
  const std::lock_guard lock(mutex_);
  const bool fits = Fits(arrival, bytes);
  if (fits) {
    all_bytes_ += bytes;
    if (std::holds_alternative<Order>(arrival))
      queue_.push_front(std::move(arrival));  // somebody waits for it
    else
      queue_.push_back(std::move(arrival));
  } else if (auto* chunk = std::get_if<ChunkBytes>(&arrival); chunk != nullptr && queue_.size() < limits_.items) {
    queue_.emplace_back(DiscardedChunk{chunk->robot, chunk->session, chunk->payload_idx, chunk->offset_bytes});
    all_bytes_ += BytesOf(queue_.back());
  }
  filled_.notify_one();
  return fits;
}

void Inbox::Release() {
  const std::lock_guard lock(mutex_);
  all_bytes_ -= taken_bytes_;
  taken_bytes_ = 0;
  for (const auto& [session, bytes] : taken_session_bytes_) {
    const auto found = session_bytes_.find(session);
    if ((found->second -= bytes) == 0) session_bytes_.erase(found);
  }
  taken_session_bytes_.clear();
}

std::vector<Arrival> Inbox::Take(std::int64_t bytes_max, std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  filled_.wait_for(lock, timeout, [&] { return stopped_ || woken_ || !queue_.empty(); });
  woken_ = false;
  std::vector<Arrival> taken;
  while (!queue_.empty() && taken_bytes_ < bytes_max) {
    taken_bytes_ += BytesOf(queue_.front());
    if (const auto* chunk = std::get_if<ChunkBytes>(&queue_.front()))
      taken_session_bytes_[chunk->session] += static_cast<std::int64_t>(chunk->bytes.size());
    taken.push_back(std::move(queue_.front()));
    queue_.pop_front();
  }
  return taken;
}

Inbox::Load Inbox::Look() const {
  const std::lock_guard lock(mutex_);
  return {all_bytes_, limits_.all_bytes, queue_.size()};
}

bool Inbox::Empty() const {
  const std::lock_guard lock(mutex_);
  return queue_.empty();
}

void Inbox::Wake() {
  const std::lock_guard lock(mutex_);
  woken_ = true;
  filled_.notify_one();
}

void Inbox::Stop() {
  const std::lock_guard lock(mutex_);
  stopped_ = true;
  filled_.notify_all();
}

bool Inbox::Stopped() const {
  const std::lock_guard lock(mutex_);
  return stopped_;
}

}  // namespace rigcal::dds
