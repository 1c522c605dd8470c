// From which networks connections come: nobody gets more by having many addresses of one.
#pragma once

#include <cstddef>
#include <string>
#include <unordered_map>

namespace rigcal::http {

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
