#include "server/dds/intake/inbox.h"

#include "server/base/process/guarded.h"

namespace rigcal::dds {
namespace {

std::int64_t SizeOf(const ChunkBytes& chunk) { return static_cast<std::int64_t>(chunk.bytes.size()); }

}  // namespace

bool Inbox::Fits(std::int64_t bytes, std::int64_t session_bytes) const {
  return counted_.all + bytes <= limits_.all_bytes && queue_.size() < limits_.items &&
         session_bytes <= limits_.session_bytes;
}

// It is counted once it is in the queue: before that there may be no memory for it.
void Inbox::Put(Arrival arrival, std::int64_t bytes) {
  if (std::holds_alternative<Order>(arrival))
    queue_.push_front(std::move(arrival));  // somebody waits for it
  else
    queue_.push_back(std::move(arrival));
  counted_.all += bytes;
}

bool Inbox::HasRoomFor(const Arrival& arrival) const {
  const auto* chunk = std::get_if<ChunkBytes>(&arrival);
  if (chunk == nullptr) return Fits(BytesOf(arrival), 0);
  const auto queued = counted_.of_chunks.find(chunk->session);
  return Fits(BytesOf(arrival), (queued == counted_.of_chunks.end() ? 0 : queued->second) + SizeOf(*chunk));
}

void Inbox::PutCounted(Arrival arrival) {
  const std::int64_t bytes = BytesOf(arrival);
  const auto* chunk = std::get_if<ChunkBytes>(&arrival);
  const std::int64_t chunk_bytes = chunk == nullptr ? 0 : SizeOf(*chunk);
  std::int64_t* const of_session = chunk == nullptr ? nullptr : &counted_.of_chunks[chunk->session];
  Put(std::move(arrival), bytes);
  if (of_session != nullptr) *of_session += chunk_bytes;
}

bool Inbox::Offer(Arrival arrival) {
  const std::lock_guard lock(mutex_);
  const auto* chunk = std::get_if<ChunkBytes>(&arrival);
  const bool fits = HasRoomFor(arrival);
  if (fits) {
    PutCounted(std::move(arrival));
  } else if (chunk != nullptr && queue_.size() < limits_.items) {
    Arrival discarded = DiscardedChunk{chunk->robot, chunk->session, chunk->payload_idx, chunk->offset_bytes};
    const std::int64_t discarded_bytes = BytesOf(discarded);
    Put(std::move(discarded), discarded_bytes);
  }
  filled_.notify_one();
  return fits;
}

bool Inbox::OfferWithin(Arrival arrival, std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  const bool fits = emptied_.wait_for(lock, timeout, [&] { return stopped_ || HasRoomFor(arrival); }) && !stopped_;
  if (fits) PutCounted(std::move(arrival));
  filled_.notify_one();
  return fits;
}

void Inbox::Release() {
  const std::lock_guard lock(mutex_);
  counted_.all -= taken_.all;
  taken_.all = 0;
  for (const auto& [session, bytes] : taken_.of_chunks) {
    const auto found = counted_.of_chunks.find(session);
    if ((found->second -= bytes) == 0) counted_.of_chunks.erase(found);
  }
  taken_.of_chunks.clear();
  emptied_.notify_all();
}

// What there is no memory for stays where it is.
Status Inbox::MoveFirstTo(std::vector<Arrival>& taken) {
  return Guarded([&]() -> Status {
    const std::int64_t bytes = BytesOf(queue_.front());
    const auto* chunk = std::get_if<ChunkBytes>(&queue_.front());
    std::int64_t* const of_session = chunk == nullptr ? nullptr : &taken_.of_chunks[chunk->session];
    const std::int64_t chunk_bytes = chunk == nullptr ? 0 : static_cast<std::int64_t>(chunk->bytes.size());
    taken.push_back(std::move(queue_.front()));
    queue_.pop_front();
    taken_.all += bytes;
    if (of_session != nullptr) *of_session += chunk_bytes;
    return {};
  });
}

std::vector<Arrival> Inbox::Take(std::int64_t bytes_max, std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  filled_.wait_for(lock, timeout, [&] { return stopped_ || woken_ || !queue_.empty(); });
  woken_ = false;
  std::vector<Arrival> taken;
  while (!queue_.empty() && taken_.all < bytes_max)
    if (!MoveFirstTo(taken)) break;
  if (taken.empty() && !queue_.empty() && !stopped_) AwaitMemory();
  return taken;
}

Inbox::Load Inbox::Look() const {
  const std::lock_guard lock(mutex_);
  return {counted_.all, limits_.all_bytes, queue_.size()};
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
  emptied_.notify_all();
}

bool Inbox::Stopped() const {
  const std::lock_guard lock(mutex_);
  return stopped_;
}

}  // namespace rigcal::dds
