#include "server/work_for.h"

#include "server/base/files/private_files.h"
#include "server/base/log.h"
#include "server/base/process/guarded.h"
#include "server/pipeline/workers/worker.h"

namespace rigcal {
namespace {

int WorkFor(Config config) {
  config.limits_file.clear();  // that of the environment: who started it has said all of them
  const Status limited = EnforceLimits(config);
  if (limited) return pipeline::Work(config.place, SystemClock());
  LogError(limited.error());
  return 1;
}

}  // namespace

std::optional<int> BeginProcess(Config& config) {
  SetLogLevel(config.verbose ? LogLevel::kDebug : LogLevel::kInfo);
  SetLogForm(config.log == "json" ? LogForm::kJson : LogForm::kText);
  if (const Status settled = SettlePlace(config); !settled) {
    LogError(settled.error());
    return 2;
  }
  MakePrivateFiles();
  WaitForMemory();
  return config.worker ? std::optional(WorkFor(config)) : std::nullopt;
}

sigset_t BlockSignals(std::initializer_list<int> signals) {
  sigset_t blocked;
  sigemptyset(&blocked);
  for (const int signal : signals) sigaddset(&blocked, signal);
  pthread_sigmask(SIG_BLOCK, &blocked, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  return blocked;
}

}  // namespace rigcal
