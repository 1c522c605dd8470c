// From where a request comes, also through a proxy that is trusted to tell. Pure.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rigcal::http {

// The usual text of an address in digits, "::ffff:10.0.0.1" and "[::1]" without what is around; nothing for any other
// text.
[[nodiscard]] std::optional<std::string> PlainAddress(std::string_view text);

// `remote`: who opened the connection. Where that is `proxy`, the last entry of the last of its X-Forwarded-For
// headers, which is what it added itself; `remote` where that is no address, and of everybody else.
[[nodiscard]] std::string ClientAddress(const std::string& remote, const std::string& proxy,
                                        const std::vector<std::string_view>& forwarded_for);

}  // namespace rigcal::http
