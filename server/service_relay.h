// Lets HTTP and the runner reach the DDS service, which is not always there: it is opened after them, and where several
// servers share a store one of them has it at a time.
#pragma once

#include <atomic>
#include <deque>
#include <functional>
#include <shared_mutex>
#include <string>
#include <vector>

#include "server/dds/service.h"

namespace rigcal {

// Any thread.
class ServiceRelay {
 public:
  using GivesOrder = std::function<Result<std::string>(const std::string& verb, const std::string& json)>;

  // Of no service: nothing.
  [[nodiscard]] std::vector<metrics::Reading> Readings() const;
  // To no service: lost, unless another one follows.
  void Announce(const dds::Announcement& announcement);
  // Until the next service is open it gets what was announced before it, in order; `false`: none follows.
  void AnotherFollows(bool follows);
  // What the last service had still to tell, oldest first: the next one gets it before what was announced since.
  void KeepFirst(std::deque<dds::Announcement> left);
  void Tell(const RobotId& robot) const;
  // Of no service: by Alone, where there is one; else kBusy.
  [[nodiscard]] Result<std::string> GiveOrder(const std::string& verb, const std::string& json) const;
  // Of no service: kBusy.
  [[nodiscard]] Status TakeIn(dds::Arrival arrival) const;
  [[nodiscard]] bool IsOpen() const;
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

  // While it lives, `gives` carries out orders where there is no service; an empty one: nobody does.
  class Alone {
   public:
    Alone(ServiceRelay& relay, GivesOrder gives) : relay_(relay) { relay_.SetAlone(std::move(gives)); }
    ~Alone() { relay_.SetAlone({}); }
    Alone(const Alone&) = delete;
    Alone& operator=(const Alone&) = delete;

   private:
    ServiceRelay& relay_;
  };

 private:
  void SetAlone(GivesOrder alone);
  void Set(dds::Service* service);
  mutable std::shared_mutex mutex_;
  std::atomic<bool> takes_in_ = false;  // false from when the service is to end
  dds::Service* service_ = nullptr;
  bool follows_ = false;
  std::deque<dds::Announcement> kept_;  // for the one that follows; of too many the oldest go
  GivesOrder alone_;
};

}  // namespace rigcal
