// Secrets that nobody guesses, through OpenSSL.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace rigcal {

// From the system's generator. Aborts if it has none.
[[nodiscard]] std::string RandomBytes(std::size_t count);
// 256 random bits as 64 lower-case hex digits: of a session, of a program's token.
[[nodiscard]] std::string NewSecret();
// In a time that does not tell where they differ.
[[nodiscard]] bool IsSameSecret(std::string_view a, std::string_view b);

}  // namespace rigcal
