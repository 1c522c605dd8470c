// What the DDS service, the runner and the store's other processes tell each other, as functions that are handed down.
#pragma once

#include <functional>
#include <mutex>

#include "server/pipeline/answers/answer.h"
#include "server/pipeline/runner.h"
#include "server/service_relay.h"
#include "server/shared_store.h"
#include "server/webhook/sender.h"

namespace rigcal {

using ContextOf = std::function<pipeline::AnswerContext(storage::Store&)>;

// Lets whoever was opened before the runner wake it. Any thread.
class RunnerRelay {
 public:
  void Wake();
  void Set(pipeline::Runner* next);

 private:
  std::mutex mutex_;
  pipeline::Runner* runner_ = nullptr;  // guarded by mutex_
};

// Tells those who are on DDS with this server, and receivers of alerts. Both outlive it.
[[nodiscard]] pipeline::Announcer AnnouncerHere(ServiceRelay& service, webhook::Sender& alerts);
// Tells other servers of the store, for those who are on DDS with them; nobody, where `self` has no name.
[[nodiscard]] Result<pipeline::Announcer> AnnouncerElsewhere(const storage::StorePlace& place,
                                                             const storage::SharingServer& self);
// What other processes of the store have done and want told: by `here`, which outlives it like the runner.
[[nodiscard]] SharedStore::Told ToldTo(pipeline::Runner& runner, const pipeline::Announcer& here);

// All outlive the service. What is decided is told by the service itself, and through `elsewhere`.
[[nodiscard]] dds::Callbacks CallbacksOf(const ContextOf& context_of, RunnerRelay& relay, webhook::Sender& alerts,
                                         const pipeline::Announcer& elsewhere);
// Carries out orders, one at a time, on the store of the calling thread: where several servers share the store and
// another one speaks DDS. Empty where `self` has no name. `callbacks` outlive it.
[[nodiscard]] ServiceRelay::GivesOrder OrdersAlone(const storage::StorePlace& place, const storage::SharingServer& self,
                                                   const dds::Callbacks& callbacks);

}  // namespace rigcal
