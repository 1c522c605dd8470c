// rigcal-worker: calibrates for the servers that share its store on PostgreSQL. Serves nobody: neither DDS nor HTTP.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <ctime>
#include <iostream>

#include "server/base/digests/secret.h"
#include "server/base/log.h"
#include "server/base/process/guarded.h"
#include "server/base/process/leave_soon.h"
#include "server/base/process/service_manager.h"
#include "server/base/version.h"
#include "server/bucket_watch.h"
#include "server/pipeline/runner.h"
#include "server/shared_store.h"
#include "server/work_for.h"

namespace rigcal {
namespace {

Status CheckShared(const Config& config) {
  if (config.place.server.empty())
    return Fail(ErrorCode::kInvalidInput, "a store on SQLite has one process: there is nobody to calibrate for",
                "Give --store postgresql://USER@HOST/DATABASE, as the servers have it, or let rigcald calibrate.");
  if (config.threads == 0) return Fail(ErrorCode::kInvalidInput, "--threads 0 would do nothing", "Give 1 or more.");
  return {};
}

// Until one of `signals` comes.
void WorkUntil(const sigset_t& signals, const Vitals& vitals) {
  constexpr timespec kTurnEvery{0, 500'000'000};
  Watchdog watchdog;
  TellServiceManager("READY=1");
  while (sigtimedwait(&signals, nullptr, &kTurnEvery) < 0) watchdog.Turn(vitals);
  TellServiceManager("STOPPING=1");
}

Status Serve(const Config& config, const sigset_t& signals) {
  RIGCAL_TRY(EnforceLimits(config));
  RIGCAL_TRY(CheckShared(config));
  // In containers several have the same number on machines of the same name.
  const std::string name = OwnerName(config.place, std::to_string(getpid()) + "-" + NewSecret().substr(0, 8));
  RIGCAL_ASSIGN(const pipeline::Announcer announcer, AnnouncerThroughStore(config.place, SystemClock()));
  {
    RIGCAL_ASSIGN(storage::Store store, storage::Store::Open(config.place));
    RIGCAL_TRY(BeginWithBucket(store));
  }
  Vitals vitals(SystemClock());
  RIGCAL_ASSIGN(pipeline::Runner runner, pipeline::Runner::Start({config.place, &SystemClock(), config.threads, &vitals,
                                                                  nullptr, WorkerCommand(config), name},
                                                                 announcer));
  SharedStore::Told told;
  told.work = [&runner] { runner.Wake(); };
  RIGCAL_ASSIGN(const auto shared, SharedStore::Follow(config.place, told));
  std::cout << "rigcal-worker " << Version() << " works as " << name << ": rows in " << storage::NameOf(config.place)
            << ", files in " << config.data.string() << std::endl;
  WorkUntil(signals, vitals);
  LogInfo("stopping");
  LeaveSoon();
  return {};
}

}  // namespace
}  // namespace rigcal

int main(int argc, char** argv) {
  rigcal::Config config;
  config.data = rigcal::DefaultData();
  CLI::App app("Calibrates for the Rigcal servers that share its store on PostgreSQL.", "rigcal-worker");
  rigcal::AddWorkerOptions(app, config);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (const auto ended = rigcal::BeginProcess(config)) return *ended;
  const sigset_t signals = rigcal::BlockSignals({SIGINT, SIGTERM});
  const rigcal::Status served = rigcal::Guarded([&] { return rigcal::Serve(config, signals); });
  if (served) return 0;
  rigcal::LogError(served.error());
  return served.error().code == rigcal::ErrorCode::kInvalidInput ? 2 : 1;
}
