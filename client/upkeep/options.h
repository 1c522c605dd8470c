// What the verbs on a data folder share.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "client/verb.h"

namespace rigcal::client {

// What rigcald takes without --data: $HOME/.local/share/rigcal.
[[nodiscard]] std::string DefaultDataFolder();

// A bar over contents that shows itself while `work` goes on, and is gone after it. The work may be told of from one
// thread at a time.
void WithBar(const Context& context, const std::string& label,
             const std::function<void(const std::function<void(std::int64_t done, std::int64_t total)>&)>& work);

}  // namespace rigcal::client
