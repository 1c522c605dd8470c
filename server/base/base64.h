// Bytes as text in JSON (RFC 4648, with padding).
#pragma once

#include <string>
#include <string_view>

#include "server/base/result.h"

namespace rigcal {

[[nodiscard]] std::string ToBase64(std::string_view bytes);
[[nodiscard]] Result<std::string> FromBase64(std::string_view text);

}  // namespace rigcal
