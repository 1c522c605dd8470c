// The place of this rigcald among others of its domain and tag. One on standby opens no store until it serves.
#pragma once

#include <csignal>
#include <optional>

#include "server/config.h"
#include "server/dds/only_server.h"
#include "server/dds_turn.h"
#include "server/http/server.h"

namespace rigcal {

// Claims the domain and tag: Settle() of what it gives says whether this server has them. With --standby it waits while
// another rigcald serves, one of another store, and has them then; meanwhile all of HTTP answers 503, standard output
// says for whom it waits. nullopt: one of `signals` came. `store`: OnlyServer::Open.
[[nodiscard]] Result<std::optional<dds::OnlyServer>> ClaimPlace(const Config& config, const http::Options& options,
                                                                const sigset_t& signals, const std::string& store);

// Until one of `signals` comes; on SIGHUP, where it is one of them, the certificate of `options` is read anew and
// nothing ends. What DdsTurn::Look fails with, it does.
[[nodiscard]] Status ServeUntil(const sigset_t& signals, DdsTurn& turn, const http::Options& options,
                                const std::string& data);

}  // namespace rigcal
