// Takes secrets out of text that leaves the machine. Pure.
#pragma once

#include <string>
#include <string_view>

namespace rigcal::client {

// What stands where a secret was.
inline constexpr const char* kRedacted = "[redacted]";

// `text` without: passwords and queries in addresses, paths of webhooks, what follows a name that has a word for a
// secret in it (password, secret, token, ...) and `=` or `:`, or stands in an XML element of such a name, bearer tokens
// and cookies, private keys in PEM form, the first of which ends with the text where it has no end. Names of files
// stay, as do digests. Lines that are longer than 8192 bytes are cut. A value that goes on over further lines (quoted,
// in brackets, after a backslash, a block or list of YAML, within an XML element) is taken out whole, one of webhooks
// too.
[[nodiscard]] std::string Redacted(std::string_view text);

// The same of each text in a JSON document, which stays one, however long its line; of what is no JSON, Redacted().
[[nodiscard]] std::string RedactedJson(std::string_view text);

}  // namespace rigcal::client
