// Takes secrets out of text that leaves the machine. Pure.
#pragma once

#include <string>
#include <string_view>

namespace rigcal::client {

// What stands where a secret was.
inline constexpr const char* kRedacted = "[redacted]";

// `text` without: passwords in addresses, what follows a word that names a secret (password, secret, token, ...) and
// `=` or `:`, bearer tokens and cookies, private keys in PEM form, the first of which ends with the text where it has
// no end. Names of files stay, as do digests.
[[nodiscard]] std::string Redacted(std::string_view text);

}  // namespace rigcal::client
