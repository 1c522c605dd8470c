// Lets HTTP reach the DDS service, which is opened after it and gone before it.
#pragma once

#include <shared_mutex>
#include <string>
#include <vector>

#include "server/dds/service.h"

namespace rigcal {

// Any thread.
class ServiceRelay {
 public:
  // Of no service: nothing, and kBusy.
  [[nodiscard]] std::vector<metrics::Reading> Readings() const;
  [[nodiscard]] Result<std::string> GiveOrder(const std::string& verb, const std::string& json) const;

  // While it lives, that service is reached.
  class Open {
   public:
    Open(ServiceRelay& relay, dds::Service& service) : relay_(relay) { relay_.Set(&service); }
    ~Open() { relay_.Set(nullptr); }
    Open(const Open&) = delete;
    Open& operator=(const Open&) = delete;

   private:
    ServiceRelay& relay_;
  };

 private:
  void Set(dds::Service* service);
  mutable std::shared_mutex mutex_;
  dds::Service* service_ = nullptr;
};

}  // namespace rigcal
