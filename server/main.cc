// rigcald: reads the configuration, opens the four owners of state (DDS, store, runner, HTTP), wires them, waits for a
// signal.
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <mutex>
#include <vector>

#include "server/base/files/private_files.h"
#include "server/base/log.h"
#include "server/base/process/guarded.h"
#include "server/base/process/leave_soon.h"
#include "server/base/process/service_manager.h"
#include "server/base/process/thread_rank.h"
#include "server/base/version.h"
#include "server/config.h"
#include "server/dds/service.h"
#include "server/http/public_address.h"
#include "server/http/server.h"
#include "server/logins.h"
#include "server/metrics/noted.h"
#include "server/pipeline/answers/answer.h"
#include "server/pipeline/orders/channel.h"
#include "server/pipeline/orders/orders.h"
#include "server/pipeline/robots/robot_state.h"
#include "server/pipeline/robots/summaries.h"
#include "server/pipeline/runner.h"
#include "server/reload.h"
#include "server/service_relay.h"
#include "server/shared_store.h"
#include "server/standby.h"
#include "server/thread_store.h"
#include "server/told_address.h"
#include "server/webhook/sender.h"
#include "server/work_for.h"
#include "storage/access/accounts.h"
#include "storage/files/folder_lock.h"
#include "storage/files/room.h"

namespace rigcal {
namespace {

// Lets the DDS thread wake a runner that is opened after it.
struct WakeRelay {
  std::mutex mutex;
  pipeline::Runner* runner = nullptr;
  void Wake() {
    const std::lock_guard lock(mutex);
    if (runner != nullptr) runner->Wake();
  }
  void Set(pipeline::Runner* next) {
    const std::lock_guard lock(mutex);
    runner = next;
  }
};

pipeline::Announcer AnnouncerTo(dds::Service& service, webhook::Sender& alerts) {
  pipeline::Announcer announcer;
  announcer.event = [&service, &alerts](const RobotId& robot, const std::string& kind, const std::string& subject,
                                        const std::string& json) {
    service.Announce({robot, kind, subject, SystemClock().Now(), json});
    alerts.Wake();
  };
  announcer.state = [&service](const RobotId& robot) { service.Tell(robot); };
  return announcer;
}

// What other processes of the store have done and want told.
SharedStore::Told ToldTo(pipeline::Runner& runner, const pipeline::Announcer& announcer) {
  return {[&runner] { runner.Wake(); },
          [&announcer](const storage::WaitingAnnouncement& one) {
            one.kind.empty() ? announcer.state(one.robot) : announcer.event(one.robot, one.kind, one.subject, one.json);
          }};
}

using ContextOf = std::function<pipeline::AnswerContext(storage::Store&)>;

http::Answer PagesOf(const storage::StorePlace& place, const ContextOf& context_of) {
  return [place, context_of](const std::string& path, const std::string& query) -> Result<http::Page> {
    RIGCAL_ASSIGN(storage::Store* const store, StoreOfThread(place));
    const auto began = std::chrono::steady_clock::now();
    auto page = pipeline::AnswerPage(context_of(*store), path, query);
    metrics::NoteAnswer(metrics::Channel::kHttp,
                        std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count());
    if (!page) metrics::NoteAnswerFailure(metrics::Channel::kHttp, page.error().code);
    if (!page) return Fail(page.error());
    return http::Page{std::move(page->body), std::move(page->content_type), {}, page->immutable, page->status};
  };
}

// All outlive the service.
dds::Callbacks CallbacksOf(const ContextOf& context_of, WakeRelay& relay, webhook::Sender& alerts) {
  dds::Callbacks callbacks;
  callbacks.answer = [&context_of](storage::Store& store, const std::string& verb, const std::string& json) {
    return pipeline::Answer(context_of(store), verb, json);
  };
  callbacks.is_order = pipeline::IsOrder;
  callbacks.carry_out = [&alerts](storage::Store& store, const std::string& verb, const std::string& json,
                                  OrderChannel channel) -> Result<OrderDone> {
    RIGCAL_ASSIGN(const std::string order, pipeline::WithChannel(store, json, channel));
    auto done = pipeline::CarryOut(store, SystemClock(), verb, order);
    alerts.Wake();
    return done;
  };
  callbacks.state_of = pipeline::LoadRobotState;
  callbacks.work_arrived = [&relay](const RobotId&) { relay.Wake(); };
  return callbacks;
}

Result<pipeline::Runner> StartRunner(const Config& config, pipeline::ServerHealth& health,
                                     pipeline::UndrawnReports& undrawn, const pipeline::Announcer& announcer) {
  return pipeline::Runner::Start({config.place, &SystemClock(), config.threads, &health.vitals(), &undrawn,
                                  WorkerCommand(config), OwnerName(config.place, config.data.string())},
                                 announcer);
}

void SayReady(const Config& config, const std::string& address) {
  std::cout << "rigcald " << Version() << " is ready: reports at " << address << "/ , data in " << config.data.string()
            << (config.place.server.empty() ? "" : " and " + storage::NameOf(config.place)) << std::endl;
}

struct Checked {
  http::Options http;
  std::vector<webhook::Receiver> receivers;
};

// What is wrong with the configuration is said before another server is looked for.
Result<Checked> EnforceAndCheck(const Config& config) {
  RIGCAL_TRY(EnforceLimits(config));
  RIGCAL_TRY(CheckThreads(config));
  RIGCAL_ASSIGN(http::Options http_options, HttpOptions(config));
  RIGCAL_TRY(PublicUrl(config));
  RIGCAL_ASSIGN(auto receivers, ReceiversOf(config));
  return Checked{std::move(http_options), std::move(receivers)};
}

Status ClaimFolder(const Config& config) {
  RIGCAL_TRY(storage::LockFolder(config.data));
  if (IsOpenToOthers(config.data)) LogWarn(OpenFolderText(config.data));
  storage::KeepReserve(config.data);
  return {};
}

Status ServeWatched(const sigset_t& signals, dds::OnlyServer& only, Settings& settings, const Vitals& vitals,
                    const std::string& data) {
  Watchdog watchdog;
  TellServiceManager("READY=1");
  Status ended = ServeUntil(
      signals, only, [&] { settings.ReadAgain(); }, [&] { watchdog.Turn(vitals); }, data);
  TellServiceManager("STOPPING=1");
  LogInfo("stopping");
  return ended;
}

Status Serve(const Config& config, const sigset_t& signals, Settings& settings) {
  RIGCAL_ASSIGN(Checked checked, EnforceAndCheck(config));
  http::Options& http_options = checked.http;
  settings.KeepUp(http_options.certificate);
  RIGCAL_ASSIGN(auto only, ClaimPlace(config, http_options, signals, [&] { settings.ReadAgain(); }));
  if (!only) return {};
  RIGCAL_ASSIGN(const std::string public_url, PublicUrl(settings.in_force()));
  http_options.names = NamesOf(settings.in_force());
  RIGCAL_TRY(ClaimFolder(config));
  RIGCAL_ASSIGN(storage::Store start_store, storage::Store::Open(config.place));  // migrated before anybody is served
  RIGCAL_ASSIGN(const bool has_users, storage::HasAccounts(start_store));
  RIGCAL_TRY(CheckUsers(config, http_options, has_users));
  http_options.logins = LoginsOf(config.place, SystemClock(), AlwaysNeedsLogin(config, http_options));
  ServiceRelay service_relay;
  http_options.orders = OrdersTo(service_relay);
  pipeline::RefreshAllSummaries(start_store, SystemClock());
  if (!config.standby) RIGCAL_TRY(only->Settle());
  const Stamp started_at = SystemClock().Now();
  pipeline::RevisionCache revisions;
  pipeline::ServerHealth health(config.data, SystemClock());
  pipeline::UndrawnReports undrawn;
  WakeRelay relay;
  ToldAddress told_address;  // a request that is faster than the port is known waits for it
  const ContextOf context_of = [&](storage::Store& store) -> pipeline::AnswerContext {
    return {store,      SystemClock(),         revisions,
            started_at, told_address.Get(),    &health,
            &undrawn,   [&] { relay.Wake(); }, [&] { return service_relay.Readings(); }};
  };
  RIGCAL_ASSIGN(http::Server http, http::Server::Start(http_options, PagesOf(config.place, context_of)));
  const std::string own_address = http::AddressOf(http_options, http.port(), http::MachineName());
  const std::string address = public_url.empty() ? own_address : public_url;
  told_address.Set(address);
  settings.TellOfChanges([&](const Config& now, const std::string& url) {
    http.SetNames(NamesOf(now));
    told_address.Set(url.empty() ? own_address : url);
  });
  WarnOfReach(http_options, address, has_users);

  RIGCAL_ASSIGN(webhook::Sender alerts,
                webhook::Sender::Start({config.place, &SystemClock(), std::move(checked.receivers), &health.vitals()}));
  const dds::Callbacks callbacks = CallbacksOf(context_of, relay, alerts);
  SetThreadRank(ThreadRank::kTakes);  // DDS makes threads of its own
  RIGCAL_ASSIGN(dds::Service service,
                dds::Service::Start({only->Named(config.participant), config.place, &SystemClock(), &health.vitals()},
                                    callbacks));
  const ServiceRelay::Open service_open(service_relay, service);
  SetThreadRank(ThreadRank::kServes);
  const pipeline::Announcer announcer = AnnouncerTo(service, alerts);
  RIGCAL_ASSIGN(pipeline::Runner runner, StartRunner(config, health, undrawn, announcer));
  relay.Set(&runner);
  RIGCAL_ASSIGN(const auto shared, SharedStore::Follow(config.place, ToldTo(runner, announcer)));
  SayReady(config, address);
  Status ended = ServeWatched(signals, *only, settings, health.vitals(), config.data.string());
  LeaveSoon();
  relay.Set(nullptr);
  return ended;
}

}  // namespace
}  // namespace rigcal

int main(int argc, char** argv) {
  rigcal::Config config;
  rigcal::Settings settings(argc, argv);
  if (const auto ended = settings.Read(config)) return *ended;
  if (const auto ended = rigcal::BeginProcess(config)) return *ended;
  rigcal::OnLoggedError(rigcal::metrics::NoteError);
  // Without a certificate SIGHUP ends the server that a terminal started, as when that closes.
  const bool ends_with_terminal = config.http_cert.empty() && isatty(STDERR_FILENO) == 1;
  const sigset_t signals =
      ends_with_terminal ? rigcal::BlockSignals({SIGINT, SIGTERM}) : rigcal::BlockSignals({SIGINT, SIGTERM, SIGHUP});
  const rigcal::Status served = rigcal::Guarded([&] { return rigcal::Serve(config, signals, settings); });
  if (served) return 0;
  rigcal::LogError(served.error());
  return served.error().code == rigcal::ErrorCode::kConflict ? 4 : 1;  // 4: another server is in the way
}
