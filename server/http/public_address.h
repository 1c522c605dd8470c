// The reports' address as others reach it: the scheme and what follows it, without a slash at the end.
#pragma once

#include <string>

#include "server/http/server.h"

namespace rigcal::http {

// Of what a person gave: http:// or https://, a host, and maybe a port and a path. kInvalidInput for anything else.
[[nodiscard]] Result<std::string> ReadPublicUrl(const std::string& given);

// Of a server that listens at `options.host` and `port`. Where that is every address of the machine it is `machine`,
// its name; 127.0.0.1 where the name is no host.
[[nodiscard]] std::string AddressOf(const Options& options, int port, const std::string& machine);
// This machine's name, or empty.
[[nodiscard]] std::string MachineName();

}  // namespace rigcal::http
