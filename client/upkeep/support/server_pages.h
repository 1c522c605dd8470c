// Pages of a rigcald over HTTP, for a support bundle.
#pragma once

#include <string>

#include "server/base/result.h"

namespace rigcal::client {

// `path` at `address` ("http://127.0.0.1:8420"), with its status as the first line; `token`, where it is not empty, is
// sent along. kUnreachable.
[[nodiscard]] Result<std::string> PageText(const std::string& address, const std::string& path,
                                           const std::string& token);

}  // namespace rigcal::client
