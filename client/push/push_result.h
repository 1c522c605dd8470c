// What a push prints at its end: what was sent, and what the server made of it.
#pragma once

#include <ostream>
#include <string>

#include "client/exit_code.h"
#include "client/push/await_result.h"
#include "client/wire/push_engine.h"

namespace rigcal::client {

struct PushSummary {
  std::string kind;  // "session" | "batch"
  std::string robot, id;
  std::size_t items = 0;                    // files or edges
  std::int64_t total = 0, held_before = 0;  // bytes or edges
  int restarts = 0;                         // of the server, seen on the way
  std::int64_t transfer_ns = 0;             // from looking for the server to the last receipt
};
// `transfer_ns` is left at 0 for the caller.
[[nodiscard]] PushSummary SummaryOf(const PushEngine& engine, std::string kind, std::string robot, std::string id,
                                    std::size_t items);

// Verdict, edges with sigma, E_global before and after, the report's address.
void PrintResult(const Awaited& awaited, std::ostream& out);
// Of a push that gave no revision: kVerdictUnknown.
[[nodiscard]] ExitCode JudgeResult(const Awaited& awaited);
// The verb's own JSON document; `awaited` may be null.
[[nodiscard]] std::string ResultJson(const PushSummary& summary, const Awaited* awaited);

}  // namespace rigcal::client
