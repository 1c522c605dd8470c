// Verbs that are programs of their own beside this one.
#pragma once

#include <string>

#include "client/verb.h"

namespace rigcal::client {

// Replaces this process by that program, `rigcal-check` of `check`, which gets all arguments as they were
// given. Returns only if it cannot be started.
[[nodiscard]] Error StartElsewhere(Context& context, const std::string& name);

// The name of the program that has this verb, without `rigcal-`: "upkeep" of backup; empty: none has.
[[nodiscard]] std::string ProgramOf(const std::string& verb);

}  // namespace rigcal::client
