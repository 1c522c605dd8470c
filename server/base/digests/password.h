// Passwords as they are kept: scrypt (RFC 7914) through OpenSSL.
#pragma once

#include <string>
#include <string_view>

#include "server/base/result.h"

namespace rigcal {

inline constexpr std::size_t kPasswordBytesMin = 12, kPasswordBytesMax = 1024;

// kInvalidInput where it is shorter or longer than that, no UTF-8, or has control characters.
[[nodiscard]] Status CheckPassword(std::string_view password);
// "scrypt$15$8$1$<salt>$<key>" of a new salt: N = 2^15, r = 8, p = 1, both in base64. Takes 32 MiB and about a tenth of
// a second. Aborts if OpenSSL fails, as the next do.
[[nodiscard]] std::string HashOfPassword(std::string_view password);
// Whether `hash` is of it, in constant time. False for what is no such hash, or asks for more than 256 MiB.
[[nodiscard]] bool IsPassword(std::string_view password, const std::string& hash);
// Takes as long as IsPassword() of a new hash, where there is none: who asks does not learn from the time who exists.
void SpendTimeOfPassword(std::string_view password);

}  // namespace rigcal
