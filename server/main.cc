// rigcald: reads the configuration, opens the four owners of state (DDS, store, runner, HTTP), wires them, waits for a
// signal.
#include <malloc.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <vector>

#include "server/base/log.h"
#include "server/base/process/guarded.h"
#include "server/base/process/leave_soon.h"
#include "server/base/process/service_manager.h"
#include "server/base/version.h"
#include "server/bucket_watch.h"
#include "server/centre.h"
#include "server/config.h"
#include "server/dds_callbacks.h"
#include "server/dds_turn.h"
#include "server/http/public_address.h"
#include "server/http/server.h"
#include "server/logins.h"
#include "server/metrics/noted.h"
#include "server/own_place.h"
#include "server/pipeline/answers/answer.h"
#include "server/pipeline/robots/summaries.h"
#include "server/pipeline/runner.h"
#include "server/reload.h"
#include "server/sites/forwarder.h"
#include "server/standby.h"
#include "server/thread_store.h"
#include "server/told_address.h"
#include "server/webhook/sender.h"
#include "server/work_for.h"
#include "storage/access/accounts.h"

namespace rigcal {
namespace {

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

Result<pipeline::Runner> StartRunner(const Config& config, const std::string& owner, pipeline::ServerHealth& health,
                                     pipeline::UndrawnReports& undrawn, const pipeline::Announcer& announcer) {
  return pipeline::Runner::Start(
      {config.place, &SystemClock(), config.threads, &health.vitals(), &undrawn, WorkerCommand(config), owner},
      announcer);
}

void SayReady(const Config& config, const std::string& address, const std::optional<wire::ServerName>& speaks) {
  std::cout << "rigcald " << Version() << " is ready: reports at " << address << "/ , data in " << config.data.string()
            << (config.place.server.empty() ? "" : " and " + storage::NameOf(config.place))
            << (speaks ? "; DDS here is with " + wire::TextOf(*speaks) + " until that is gone" : "") << std::endl;
}

struct Checked {
  http::Options http;
  std::vector<webhook::Receiver> receivers;
  sites::CentreAddress centre;
};

// What is wrong with the configuration is said before another server is looked for.
Result<Checked> EnforceAndCheck(const Config& config) {
  RIGCAL_TRY(EnforceLimits(config));
  RIGCAL_TRY(CheckThreads(config));
  RIGCAL_ASSIGN(http::Options http_options, HttpOptions(config));
  RIGCAL_TRY(PublicUrl(config));
  RIGCAL_ASSIGN(auto receivers, ReceiversOf(config));
  RIGCAL_ASSIGN(auto centre, CentreOf(config));
  return Checked{std::move(http_options), std::move(receivers), std::move(centre)};
}

Status ServeWatched(const sigset_t& signals, DdsTurn& dds, Settings& settings, const Vitals& vitals,
                    const std::string& data) {
  Watchdog watchdog;
  TellServiceManager("READY=1");
  Status ended = ServeUntil(
      signals, dds,
      [&] {
        settings.ReadAgain();
        dds.LookAtIdentity();
      },
      [&] { watchdog.Turn(vitals); }, data);
  TellServiceManager("STOPPING=1");
  LogInfo("stopping");
  return ended;
}

// Under which names pages are served, to whom, and whom their orders reach; whether there are users.
Result<bool> SettleReach(const Config& config, const Settings& settings, storage::Store& store, ServiceRelay& relay,
                         http::Options& options) {
  options.names = NamesOf(settings.in_force());
  RIGCAL_ASSIGN(const bool has_users, storage::HasAccounts(store));
  RIGCAL_TRY(CheckUsers(config, options, has_users));
  options.logins = LoginsOf(config.place, SystemClock(), AlwaysNeedsLogin(config, options));
  options.orders = OrdersTo(relay);
  return has_users;
}

Status Serve(const Config& config, const sigset_t& signals, Settings& settings) {
  RIGCAL_ASSIGN(Checked checked, EnforceAndCheck(config));
  http::Options& http_options = checked.http;
  settings.KeepUp(http_options.certificate);
  RIGCAL_ASSIGN(OwnPlace own, ClaimOwnPlace(config, http_options, signals, [&] { settings.ReadAgain(); }));
  if (!own.only) return {};
  RIGCAL_ASSIGN(const std::string public_url, PublicUrl(settings.in_force()));
  ServiceRelay service_relay;
  RIGCAL_ASSIGN(const bool has_users, SettleReach(config, settings, *own.store, service_relay, http_options));
  dds::ReceiptWatches watches;
  http_options.answer_site = AnswerSites(config.place, service_relay, watches);
  pipeline::RefreshAllSummaries(*own.store, SystemClock());
  RIGCAL_ASSIGN(const auto speaks, WhoElseSpeaks(config, *own.only));
  const Stamp started_at = SystemClock().Now();
  pipeline::RevisionCache revisions;
  pipeline::ServerHealth health(config.data, SystemClock());
  pipeline::UndrawnReports undrawn;
  RunnerRelay relay;
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
  RIGCAL_ASSIGN(const pipeline::Announcer elsewhere, AnnouncerElsewhere(config.place, own.self));
  RIGCAL_ASSIGN(sites::Forwarder forwarder,
                sites::Forwarder::Start(ForwardingOf(config.place, checked.centre, health.vitals(), service_relay)));
  const auto callbacks = WithSites(CallbacksOf(context_of, relay, alerts, elsewhere), watches, forwarder);
  DdsTurn turn(*own.only, service_relay, config.participant, [&](std::chrono::milliseconds announces_after) {
    return dds::Service::Start({own.only->Named(config.participant), config.place, &SystemClock(), &health.vitals(),
                                announces_after, own.intake},
                               callbacks);
  });
  const ServiceRelay::Alone alone(service_relay, OrdersAlone(config.place, own.self, callbacks));
  if (!speaks) RIGCAL_TRY(turn.Speak());
  const pipeline::Announcer here = AnnouncerHere(service_relay, alerts);
  RIGCAL_ASSIGN(pipeline::Runner runner, StartRunner(config, own.self.owner, health, undrawn, Both(here, elsewhere)));
  relay.Set(&runner);
  RIGCAL_ASSIGN(const auto shared, SharedStore::Follow(config.place, ToldTo(runner, here), own.self));
  RIGCAL_ASSIGN(const auto bucket_watch, BucketWatch::Start(config.place, health.vitals()));
  SayReady(config, address, speaks);
  Status ended = ServeWatched(signals, turn, settings, health.vitals(), config.data.string());
  LeaveSoon();
  relay.Set(nullptr);
  return ended;
}

}  // namespace
}  // namespace rigcal

int main(int argc, char** argv) {
  // Of what a large message took each heap keeps its own, and every thread that ever took one would have a heap.
  mallopt(M_ARENA_MAX, 2);
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
