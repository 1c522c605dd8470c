#include "server/dds_callbacks.h"

#include <memory>

#include "server/pipeline/orders/orders.h"
#include "server/pipeline/robots/robot_state.h"
#include "server/thread_store.h"

namespace rigcal {

void RunnerRelay::Wake() {
  const std::lock_guard lock(mutex_);
  if (runner_ != nullptr) runner_->Wake();
}

void RunnerRelay::Set(pipeline::Runner* next) {
  const std::lock_guard lock(mutex_);
  runner_ = next;
}

pipeline::Announcer AnnouncerHere(ServiceRelay& service, webhook::Sender& alerts) {
  pipeline::Announcer announcer;
  announcer.event = [&service, &alerts](const RobotId& robot, const std::string& kind, const std::string& subject,
                                        const std::string& json) {
    service.Announce({robot, kind, subject, SystemClock().Now(), json});
    alerts.Wake();
  };
  announcer.state = [&service](const RobotId& robot) { service.Tell(robot); };
  return announcer;
}

Result<pipeline::Announcer> AnnouncerElsewhere(const storage::StorePlace& place, const storage::SharingServer& self) {
  if (!self.owner.empty()) return AnnouncerThroughStore(place, SystemClock(), self.owner);
  pipeline::Announcer nobody;
  nobody.event = [](const RobotId&, const std::string&, const std::string&, const std::string&) {};
  nobody.state = [](const RobotId&) {};
  return nobody;
}

SharedStore::Told ToldTo(pipeline::Runner& runner, const pipeline::Announcer& here) {
  return {[&runner] { runner.Wake(); },
          [&here](const storage::WaitingAnnouncement& one) {
            one.kind.empty() ? here.state(one.robot) : here.event(one.robot, one.kind, one.subject, one.json);
          }};
}

dds::Callbacks CallbacksOf(const ContextOf& context_of, RunnerRelay& relay, webhook::Sender& alerts,
                           const pipeline::Announcer& elsewhere) {
  dds::Callbacks callbacks;
  callbacks.answer = [&context_of](storage::Store& store, const std::string& verb, const std::string& json) {
    return pipeline::Answer(context_of(store), verb, json);
  };
  callbacks.is_order = pipeline::IsOrder;
  callbacks.carry_out = [&alerts, &elsewhere](storage::Store& store, const std::string& verb, const std::string& json,
                                              const OrderOrigin& origin) -> Result<OrderDone> {
    RIGCAL_TRY(pipeline::CheckMayGive(verb, origin));
    RIGCAL_ASSIGN(const std::string order, pipeline::WithChannel(store, json, origin));
    auto done = pipeline::CarryOut(store, SystemClock(), verb, order);
    alerts.Wake();
    if (!done || done->decided == 0) return done;
    elsewhere.state(done->robot);
    elsewhere.event(done->robot, "decision", std::to_string(done->decided), done->document);
    return done;
  };
  callbacks.state_of = pipeline::LoadRobotState;
  callbacks.work_arrived = [&relay](const RobotId&) { relay.Wake(); };
  return callbacks;
}

ServiceRelay::GivesOrder OrdersAlone(const storage::StorePlace& place, const storage::SharingServer& self,
                                     const dds::Callbacks& callbacks) {
  if (self.owner.empty()) return {};
  const auto one_at_a_time = std::make_shared<std::mutex>();
  return [place, &callbacks, one_at_a_time](const std::string& verb, const std::string& json) -> Result<std::string> {
    const std::lock_guard lock(*one_at_a_time);
    RIGCAL_ASSIGN(storage::Store* const store, StoreOfThread(place));
    RIGCAL_ASSIGN(OrderDone done, callbacks.carry_out(*store, verb, json, {OrderChannel::kHttp}));
    callbacks.work_arrived(done.robot);
    return std::move(done.document);
  };
}

}  // namespace rigcal
