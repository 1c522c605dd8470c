// The place of this rigcald among others of its domain and tag. One on standby opens no store until it serves.
#pragma once

#include <csignal>
#include <functional>
#include <optional>

#include "server/config.h"
#include "server/dds/only_server.h"
#include "server/dds_turn.h"
#include "server/http/server.h"

namespace rigcal {

// Claims the domain and tag: Settle() of what it gives says whether this server has them. With --standby it waits while
// another rigcald serves, one of another store, and has them then; meanwhile all of HTTP answers 503, standard output
// says for whom it waits. nullopt: one of `signals` came. On SIGHUP, where it is one of them, nothing ends: `hang_up`
// is called. `store`: OnlyServer::Open.
[[nodiscard]] Result<std::optional<dds::OnlyServer>> ClaimPlace(const Config& config, const http::Options& options,
                                                                const sigset_t& signals,
                                                                const std::function<void()>& hang_up,
                                                                const std::string& store);

// Until one of `signals` comes; SIGHUP as above. `turn` is called five times a second. Where DdsTurn::Look finds
// another server in the way, it fails with that; what else goes wrong there is logged.
[[nodiscard]] Status ServeUntil(const sigset_t& signals, DdsTurn& dds, const std::function<void()>& hang_up,
                                const std::function<void()>& turn, const std::string& data);

}  // namespace rigcal
