#include "server/standby.h"

#include <ctime>
#include <iostream>

#include "server/base/log.h"
#include "server/base/process/guarded.h"
#include "server/base/process/service_manager.h"
#include "server/base/process/thread_rank.h"
#include "server/base/version.h"

namespace rigcal {
namespace {

constexpr timespec kLookEvery{0, 200'000'000};

// The same of every path, and to strangers too: for whom this one waits is in the log.
Error OnStandby() {
  return {ErrorCode::kBusy, "this rigcald is on standby: another one serves",
          "Ask that one, which this one's log names; this one takes over when it is gone"};
}

// True: a signal came that ends the server.
bool Pause(const sigset_t& signals, const std::function<void()>& hang_up) {
  const int signal = sigtimedwait(&signals, nullptr, &kLookEvery);
  if (signal != SIGHUP) return signal > 0;
  hang_up();
  return false;
}

// True: this one serves now. False: a signal came.
Result<bool> StandBy(dds::OnlyServer& only, const http::Options& options, const sigset_t& signals,
                     const std::function<void()>& hang_up) {
  RIGCAL_ASSIGN(const auto serves, TakePlace(only));
  if (!serves || only.SharesStoreWith(*serves)) return true;
  http::Options nothing = options;
  nothing.folder.clear();
  RIGCAL_ASSIGN(const http::Server http,
                http::Server::Start(nothing, [](const std::string&, const std::string&) -> Result<http::Page> {
                  return Fail(OnStandby());
                }));
  Watchdog watchdog;
  const Vitals nothing_works(SystemClock());
  for (bool said = false;;) {
    watchdog.Turn(nothing_works);
    RIGCAL_ASSIGN(const auto first, only.Before());
    if (first && !said)
      std::cout << "rigcald " << Version() << " is on standby for " << wire::TextOf(*first) << ": "
                << (options.certificate ? "https://" : "http://") << options.host << ":" << http.port() << "/healthz"
                << std::endl;
    if (first && !said) TellServiceManager("READY=1\nSTATUS=on standby");
    said = said || first;
    if (!first) {
      RIGCAL_ASSIGN(const auto faster, TakePlace(only));
      if (!faster) break;
    }
    if (Pause(signals, hang_up)) return false;
  }
  Watchdog::HavePatience();
  LogInfo("the other server is gone: this one takes over");
  return true;
}

}  // namespace

Result<std::optional<dds::OnlyServer>> ClaimPlace(const Config& config, const http::Options& options,
                                                  const sigset_t& signals, const std::function<void()>& hang_up,
                                                  const std::string& store) {
  SetThreadRank(ThreadRank::kTakes);  // DDS makes threads of its own
  auto only = dds::OnlyServer::Open(config.participant, config.data, config.standby, store);
  SetThreadRank(ThreadRank::kServes);
  if (!only) return Fail(only.error());
  if (!config.standby) return std::move(*only);
  RIGCAL_ASSIGN(const bool serves, StandBy(*only, options, signals, hang_up));
  if (!serves) return std::nullopt;
  return std::move(*only);
}

Status ServeUntil(const sigset_t& signals, DdsTurn& dds, const std::function<void()>& hang_up,
                  const std::function<void()>& turn, const std::string& data) {
  while (!Pause(signals, hang_up)) {
    turn();
    Status looked = Guarded([&] { return dds.Look(); });
    if (looked) continue;
    if (looked.error().code == ErrorCode::kConflict) {
      looked.error().cure += ". This one came later and ends; what it took in meanwhile is in " + data;
      return looked;
    }
    OnceThereIsMemory([&] { LogWarn(Sentence(looked.error())); });
  }
  return {};
}

}  // namespace rigcal
