// What `import` and `push` of a bag share: the bar while it is read, and what is told of what could not be.
#pragma once

#include <cmath>
#include <optional>

#include "client/import/import.h"
#include "client/text/progress.h"
#include "client/verb.h"
#include "client/wire/transfer.h"

namespace rigcal::client {

// What could not be read is said after what could, and decides the code.
ExitCode TellDamage(const std::vector<Error>& damage, const Context& context);
// Of an import: the same, and kVerdictWarn too where a sensor of rig.yaml has nothing, or not all that was meant.
ExitCode TellMissing(const importing::ImportOutcome& outcome, const Context& context);

// Whole nanoseconds; nothing of a negative number, which stands for "as rig.yaml says".
[[nodiscard]] inline std::optional<std::int64_t> NanosecondsIfGiven(double seconds) {
  return seconds < 0 ? std::nullopt : std::optional<std::int64_t>(std::llround(seconds * 1e9));
}

// What `work` returns, which is given an importing::Progress that draws a bar.
template <typename Work>
auto WithBar(const Context& context, const Work& work) {
  Progress bar(context.err, context.err_is_terminal, "Reading", SteadyNow_ns(), Progress::Unit::kBytes);
  auto result = work([&](std::int64_t done, std::int64_t total) { bar.Show({done, total, ""}, SteadyNow_ns()); });
  bar.Clear();
  return result;
}

}  // namespace rigcal::client
