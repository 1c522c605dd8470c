// OMG IDL as words and signs, without comments and annotations.
#pragma once

#include <string_view>
#include <vector>

#include "server/base/result.h"

namespace rigcal::bags {

// Names keep their "::"; a text in quotes is one token that begins with its quote. A line of '=' and a line that begins
// with '#' or "IDL:" are left out, and so are annotations with what is in their parentheses. Refuses a comment or a
// text without an end. Tokens point into `text`.
[[nodiscard]] Result<std::vector<std::string_view>> IdlTokens(std::string_view text);

}  // namespace rigcal::bags
