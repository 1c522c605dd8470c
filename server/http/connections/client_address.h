// From where a request comes, also through a proxy that is trusted to tell, and from which networks connections come:
// nobody gets more by having many addresses of one. Pure.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace rigcal::http {

// The usual text of an address in digits, "::ffff:10.0.0.1" and "[::1]" without what is around; nothing for any other
// text.
[[nodiscard]] std::optional<std::string> PlainAddress(std::string_view text);

// `remote`: who opened the connection. Where that is `proxy`, the last entry of the last of its X-Forwarded-For
// headers, which is what it added itself; `remote` where that is no address, and of everybody else.
[[nodiscard]] std::string ClientAddress(const std::string& remote, const std::string& proxy,
                                        const std::vector<std::string_view>& forwarded_for);

// Whoever has one address of it has all of them: of IPv6 the first 64 bits, without the zone of "fe80::1%eth0"; any
// other text as it is.
[[nodiscard]] std::string NetworkOf(const std::string& address);

// How many there are of each.
class NetworkCounts {
 public:
  void Add(const std::string& address);
  void Remove(const std::string& address);  // no more than were added
  [[nodiscard]] std::size_t Of(const std::string& address) const;
  // NetworkOf those that are most; of equals the first by its text; empty where there is none.
  [[nodiscard]] std::string Largest() const;

 private:
  std::unordered_map<std::string, std::size_t> counts_;
};

}  // namespace rigcal::http
