#include "server/pipeline/workers/memory_on_behalf.h"

#include <thread>

#include "server/base/process/guarded.h"

namespace rigcal::pipeline {

void MemoryOnBehalf::Ask(const std::string& id, std::int64_t bytes) {
  const std::lock_guard lock(mutex_);
  asked_.emplace_back(id, bytes);
  if (asking_) return;
  std::thread([self = shared_from_this()] { self->TakeAll(); }).detach();
  asking_ = true;
}

void MemoryOnBehalf::Give(const std::string& id) {
  const std::lock_guard lock(mutex_);
  shares_.erase(id);
}

void MemoryOnBehalf::End() {
  const std::lock_guard lock(mutex_);
  ended_ = true;
  asked_.clear();
  shares_.clear();
}

void MemoryOnBehalf::TakeAll() {
  while (OnceThereIsMemory([this] { return TakeFirst(); })) {
  }
}

bool MemoryOnBehalf::TakeFirst() {
  std::unique_lock lock(mutex_);
  if (asked_.empty()) {
    asking_ = false;
    return false;
  }
  const auto [id, bytes] = asked_.front();
  lock.unlock();
  auto share = DecodingBudget().Take(bytes);
  lock.lock();
  if (ended_) asked_.clear();
  if (ended_) return true;
  if (share) shares_.emplace(id, std::move(*share));
  granted_(id);
  asked_.pop_front();
  return true;
}

}  // namespace rigcal::pipeline
