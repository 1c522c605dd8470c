#include "server/service_relay.h"

#include <mutex>

namespace rigcal {

void ServiceRelay::Set(dds::Service* service) {
  const std::unique_lock lock(mutex_);
  service_ = service;
}

std::vector<metrics::Reading> ServiceRelay::Readings() const {
  const std::shared_lock lock(mutex_);
  return service_ == nullptr ? std::vector<metrics::Reading>() : service_->Readings();
}

Result<std::string> ServiceRelay::GiveOrder(const std::string& verb, const std::string& json) const {
  const std::shared_lock lock(mutex_);
  if (service_ != nullptr) return service_->GiveOrder(verb, json);
  return Fail(ErrorCode::kBusy, "the server starts or stops", "Try again in a moment.");
}

}  // namespace rigcal
