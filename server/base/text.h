// Text from outside, made safe to repeat in messages.
#pragma once

#include <string>
#include <string_view>

namespace rigcal {

// In double quotes, printable ASCII only (other bytes as \xNN), cut with "..." after 80 bytes: for error messages.
[[nodiscard]] std::string Quoted(std::string_view text);
// Valid UTF-8 without control characters: safe in JSON, HTML and on a terminal.
[[nodiscard]] bool IsPrintableUtf8(std::string_view text);

}  // namespace rigcal
