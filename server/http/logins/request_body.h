// What a request brings beside its head.
#pragma once

#include <civetweb.h>

#include <string>
#include <tl/expected.hpp>

#include "server/http/allowed_hosts.h"

namespace rigcal::http {

// The whole body, of that type. Refused: 411 without a length, 413 beyond `bytes_max`, 415 of another type, 400 where
// it does not come. Whoever sends it slowly is put out once others wait.
[[nodiscard]] tl::expected<std::string, Refusal> ReadBody(mg_connection* connection, const std::string& type,
                                                          std::size_t bytes_max);

}  // namespace rigcal::http
