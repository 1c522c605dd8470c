#include "server/work_for.h"

#include "server/base/log.h"
#include "server/pipeline/workers/worker.h"

namespace rigcal {

int WorkFor(Config config) {
  config.limits_file.clear();  // that of the environment: who started it has said all of them
  const Status limited = EnforceLimits(config);
  if (limited) return pipeline::Work(config.place, SystemClock());
  LogError(limited.error());
  return 1;
}

}  // namespace rigcal
