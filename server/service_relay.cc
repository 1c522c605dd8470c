#include "server/service_relay.h"

#include <iterator>
#include <mutex>

namespace rigcal {
namespace {

constexpr std::size_t kKeptMax = 10'000;

}  // namespace

void ServiceRelay::Set(dds::Service* service) {
  takes_in_ = service != nullptr;
  const std::unique_lock lock(mutex_);
  service_ = service;
  if (service_ == nullptr) return;
  for (const dds::Announcement& announcement : kept_) service_->Announce(announcement);
  kept_.clear();
  follows_ = false;
}

void ServiceRelay::AnotherFollows(bool follows) {
  const std::unique_lock lock(mutex_);
  follows_ = follows;
  if (!follows_) kept_.clear();
}

void ServiceRelay::KeepFirst(std::deque<dds::Announcement> left) {
  const std::unique_lock lock(mutex_);
  left.insert(left.end(), std::make_move_iterator(kept_.begin()), std::make_move_iterator(kept_.end()));
  kept_ = std::move(left);
  while (kept_.size() > kKeptMax) kept_.pop_front();
}

void ServiceRelay::SetAlone(GivesOrder alone) {
  const std::unique_lock lock(mutex_);
  alone_ = std::move(alone);
}

std::vector<metrics::Reading> ServiceRelay::Readings() const {
  const std::shared_lock lock(mutex_);
  return service_ == nullptr ? std::vector<metrics::Reading>() : service_->Readings();
}

void ServiceRelay::Announce(const dds::Announcement& announcement) {
  {
    const std::shared_lock lock(mutex_);
    if (service_ != nullptr) return service_->Announce(announcement);
  }
  const std::unique_lock lock(mutex_);
  if (service_ != nullptr) return service_->Announce(announcement);
  if (!follows_) return;
  if (kept_.size() >= kKeptMax) kept_.pop_front();
  kept_.push_back(announcement);
}

void ServiceRelay::Tell(const RobotId& robot) const {
  const std::shared_lock lock(mutex_);
  if (service_ != nullptr) service_->Tell(robot);
}

Result<std::string> ServiceRelay::GiveOrder(const std::string& verb, const std::string& json) const {
  const std::shared_lock lock(mutex_);
  if (service_ != nullptr) return service_->GiveOrder(verb, json);
  if (alone_) return alone_(verb, json);
  return Fail(ErrorCode::kBusy, "the server starts or stops", "Try again in a moment.");
}

Status ServiceRelay::TakeIn(dds::Arrival arrival) const {
  // Whoever waits to end the service would wait for ever for those that send one piece after the other.
  const Error closed{ErrorCode::kBusy, "this server does not take in what robots push now", "Try again in a moment."};
  if (!takes_in_) return Fail(closed);
  const std::shared_lock lock(mutex_);
  if (service_ != nullptr) return service_->TakeIn(std::move(arrival));
  return Fail(closed);
}

bool ServiceRelay::IsOpen() const {
  if (!takes_in_) return false;
  const std::shared_lock lock(mutex_);
  return service_ != nullptr;
}

}  // namespace rigcal
