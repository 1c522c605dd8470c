#include "server/dds/tell/receipt_watches.h"

namespace rigcal::dds {

ReceiptWatches::Watch::Watch(ReceiptWatches& watches, std::string subject_id)
    : watches_(watches), subject_id_(std::move(subject_id)) {
  const std::lock_guard lock(watches_.mutex_);
  Heard& heard = watches_.by_subject_[subject_id_];
  ++heard.watches;
  seen_ = heard.count;
}

ReceiptWatches::Watch::~Watch() {
  const std::lock_guard lock(watches_.mutex_);
  const auto heard = watches_.by_subject_.find(subject_id_);
  if (--heard->second.watches == 0) watches_.by_subject_.erase(heard);
}

std::optional<wire::Receipt> ReceiptWatches::Watch::Await(const std::function<bool(const wire::Receipt&)>& is_enough,
                                                          std::chrono::steady_clock::time_point until) {
  std::unique_lock lock(watches_.mutex_);
  const Heard& heard = watches_.by_subject_.at(subject_id_);  // stays where it is as long as it is watched
  while (true) {
    if (!watches_.came_.wait_until(lock, until, [&] { return heard.count != seen_; })) return std::nullopt;
    seen_ = heard.count;
    if (is_enough(heard.newest)) return heard.newest;
  }
}

bool ReceiptWatches::Note(const wire::Receipt& receipt) {
  const std::lock_guard lock(mutex_);
  const auto heard = by_subject_.find(receipt.subject_id);
  if (heard == by_subject_.end()) return false;
  heard->second.newest = receipt;
  ++heard->second.count;
  came_.notify_all();
  return true;
}

}  // namespace rigcal::dds
