// HMAC-SHA-256 (RFC 2104) through OpenSSL.
#pragma once

#include <string_view>

#include "server/base/ids.h"

namespace rigcal {

// 64 lower-case hex digits. Aborts if OpenSSL has no HMAC. A key of any length.
[[nodiscard]] Digest HmacSha256(std::string_view key, std::string_view text);

}  // namespace rigcal
