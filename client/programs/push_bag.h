// The verb `push` where bags can be read: of the program rigcal-import.
#pragma once

#include "client/verbs.h"

namespace rigcal::client {

// As AddPush, and a bag becomes a session folder here.
void AddPushOfBags(CLI::App& app, Context& context);

}  // namespace rigcal::client
