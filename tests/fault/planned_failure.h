// One operation that fails, chosen while programs run: disk_record.py's Plan writes the file RIGCAL_FAULT_PLAN.
#pragma once

#include <string_view>

namespace rigcal::fault {

// Whether the operation is the one, counted over all processes that share the plan; then errno is set, or the process
// killed where the plan has no error. Kinds: open, write, sync, rename, change (of names and sizes).
[[nodiscard]] bool FailsAsPlanned(std::string_view kind);
// Likewise for a row of operations that begins with the one: the plan's error is how many. Kinds: memory, large.
[[nodiscard]] bool FailsInRow(std::string_view kind);

}  // namespace rigcal::fault
