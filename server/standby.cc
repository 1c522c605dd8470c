#include "server/standby.h"

#include <ctime>
#include <iostream>

#include "server/base/log.h"
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

void ReadAnew(http::Certificate& certificate) {
  const Status read = certificate.Reload();
  if (read) return LogInfo("the certificate was read anew: connections from now on see it");
  LogError({read.error().code, read.error().what + ", so the certificate of before is still shown", read.error().cure});
}

// True: a signal came that ends the server.
bool Pause(const sigset_t& signals, const http::Options& options) {
  const int signal = sigtimedwait(&signals, nullptr, &kLookEvery);
  if (signal != SIGHUP) return signal > 0;
  if (options.certificate) ReadAnew(*options.certificate);
  return false;
}

// True: this one serves now. False: a signal came.
Result<bool> StandBy(dds::OnlyServer& only, const http::Options& options, const sigset_t& signals) {
  RIGCAL_ASSIGN(const auto serves, TakePlace(only));
  if (!serves || only.SharesStoreWith(*serves)) return true;
  http::Options nothing = options;
  nothing.folder.clear();
  RIGCAL_ASSIGN(const http::Server http,
                http::Server::Start(nothing, [](const std::string&, const std::string&) -> Result<http::Page> {
                  return Fail(OnStandby());
                }));
  for (bool said = false;;) {
    RIGCAL_ASSIGN(const auto first, only.Before());
    if (first && !said)
      std::cout << "rigcald " << Version() << " is on standby for " << wire::TextOf(*first) << ": "
                << (options.certificate ? "https://" : "http://") << options.host << ":" << http.port() << "/healthz"
                << std::endl;
    said = said || first;
    if (!first) {
      RIGCAL_ASSIGN(const auto faster, TakePlace(only));
      if (!faster) break;
    }
    if (Pause(signals, options)) return false;
  }
  LogInfo("the other server is gone: this one takes over");
  return true;
}

}  // namespace

Result<std::optional<dds::OnlyServer>> ClaimPlace(const Config& config, const http::Options& options,
                                                  const sigset_t& signals, const std::string& store) {
  SetThreadRank(ThreadRank::kTakes);  // DDS makes threads of its own
  auto only = dds::OnlyServer::Open(config.participant, config.data, config.standby, store);
  SetThreadRank(ThreadRank::kServes);
  if (!only) return Fail(only.error());
  if (!config.standby) return std::move(*only);
  RIGCAL_ASSIGN(const bool serves, StandBy(*only, options, signals));
  if (!serves) return std::nullopt;
  return std::move(*only);
}

Status ServeUntil(const sigset_t& signals, DdsTurn& turn, const http::Options& options, const std::string& data) {
  while (!Pause(signals, options)) {
    Status looked = turn.Look();
    if (looked) continue;
    looked.error().cure += ". This one came later and ends; what it took in meanwhile is in " + data;
    return looked;
  }
  return {};
}

}  // namespace rigcal
