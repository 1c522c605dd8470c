// What rigcald and rigcal-worker have in common: how their processes begin, and the process that works for the one that
// started it, which is the same program with --worker.
#pragma once

#include <csignal>
#include <initializer_list>
#include <optional>

#include "server/config.h"

namespace rigcal {

// After the command line was read: log, store, who may read files. With --worker also the whole life of such a process,
// which whoever started it ends: SIGINT and SIGTERM come to all processes of a terminal or a service. The exit code,
// where the process is to end.
[[nodiscard]] std::optional<int> BeginProcess(Config& config);
// These are waited for from here on, by every thread. Call it before any thread is made.
[[nodiscard]] sigset_t BlockSignals(std::initializer_list<int> signals);

}  // namespace rigcal
