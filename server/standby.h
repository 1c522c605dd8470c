// The place of this rigcald among others of its domain and tag. One on standby opens no store until it serves.
#pragma once

#include <csignal>
#include <functional>
#include <optional>

#include "server/config.h"
#include "server/dds/only_server.h"
#include "server/http/server.h"

namespace rigcal {

// Claims the domain and tag: Settle() of what it gives says whether this server has them. With --standby it waits while
// another rigcald serves, and has them then; meanwhile all of HTTP answers 503, standard output says for whom it waits.
// nullopt: one of `signals` came. On SIGHUP, where it is one of them, nothing ends: `hang_up` is called.
[[nodiscard]] Result<std::optional<dds::OnlyServer>> ClaimPlace(const Config& config, const http::Options& options,
                                                                const sigset_t& signals,
                                                                const std::function<void()>& hang_up);

// Until one of `signals` comes; SIGHUP as above. `turn` is called five times a second. Fails if another server is found
// that goes before this one: the network was cut, say, and is whole again.
[[nodiscard]] Status ServeUntil(const sigset_t& signals, dds::OnlyServer& only, const std::function<void()>& hang_up,
                                const std::function<void()>& turn, const std::string& data);

}  // namespace rigcal
