// What this server has for itself, or shares with others: its data folder, its store, its place on the DDS domain and
// tag.
#pragma once

#include <csignal>
#include <functional>
#include <optional>
#include <vector>

#include "server/config.h"
#include "server/dds/only_server.h"
#include "server/http/server.h"
#include "storage/store.h"
#include "storage/work/servers.h"

namespace rigcal {

struct OwnPlace {
  std::optional<storage::Store> store;  // migrated
  std::optional<dds::OnlyServer> only;  // claimed; nothing: one of the signals came while it waited for it
  storage::SharingServer self;          // listed in the store; no name: the store is this process's alone
  std::string intake;                   // dds::Options::intake
};

// A store on PostgreSQL is shared, and opened before the place is claimed: servers of one store know each other by its
// id. Any other store is opened once the place is had. `hang_up`: ClaimPlace in standby.h.
[[nodiscard]] Result<OwnPlace> ClaimOwnPlace(const Config& config, const http::Options& options,
                                             const sigset_t& signals, const std::function<void()>& hang_up);

// Whether this server may speak DDS now; the name: one of the same store does, and this one stands ready. kConflict:
// one of another store does.
[[nodiscard]] Result<std::optional<wire::ServerName>> WhoElseSpeaks(const Config& config, dds::OnlyServer& only);

}  // namespace rigcal
