// Bytes as text in JSON (RFC 4648, with padding).
#pragma once

#include <string>
#include <string_view>

#include "server/base/result.h"

namespace rigcal {

// Standard alphabet, in one line, with '=' padding.
[[nodiscard]] std::string ToBase64(std::string_view bytes);
// The bytes; kInvalidInput where the text is not base64 or its length no multiple of 4.
[[nodiscard]] Result<std::string> FromBase64(std::string_view text);

}  // namespace rigcal
