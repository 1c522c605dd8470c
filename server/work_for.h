// The process that works for the one that started it, rigcald or rigcal-worker: the same program with --worker.
#pragma once

#include "server/config.h"

namespace rigcal {

// Its whole life. The exit code. Who started it leaves it alone with SIGINT and SIGTERM, which come to all processes of a terminal or
// a service.
[[nodiscard]] int WorkFor(Config config);

}  // namespace rigcal
