// A rigcald that is ready to take over: it opens no store until the one that serves is gone.
#pragma once

#include <csignal>

#include "server/dds/only_server.h"
#include "server/http/server.h"

namespace rigcal {

// Waits while another rigcald serves; meanwhile all of HTTP answers 503 and says for whom it waits. True: this one
// serves now. False: one of `signals` came.
[[nodiscard]] Result<bool> StandBy(dds::OnlyServer& only, const http::Options& options, const sigset_t& signals);

// Until one of `signals` comes. Fails if another server is found that goes before this one: the network was cut, say,
// and is whole again.
[[nodiscard]] Status ServeUntil(const sigset_t& signals, dds::OnlyServer& only, const std::string& data);

}  // namespace rigcal
