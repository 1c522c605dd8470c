#include "server/http/connections/networks.h"

#include <arpa/inet.h>

namespace rigcal::http {

std::string NetworkOf(const std::string& address) {
  in6_addr six{};
  if (inet_pton(AF_INET6, address.substr(0, address.find('%')).c_str(), &six) != 1 || IN6_IS_ADDR_V4MAPPED(&six))
    return address;
  return {reinterpret_cast<const char*>(six.s6_addr), 8};
}

void NetworkCounts::Add(const std::string& address) { ++counts_[NetworkOf(address)]; }

void NetworkCounts::Remove(const std::string& address) {
  const auto found = counts_.find(NetworkOf(address));
  if (found != counts_.end() && --found->second == 0) counts_.erase(found);
}

std::size_t NetworkCounts::Of(const std::string& address) const {
  const auto found = counts_.find(NetworkOf(address));
  return found == counts_.end() ? 0 : found->second;
}

std::string NetworkCounts::Largest() const {
  std::string largest;
  std::size_t most = 0;
  for (const auto& [network, count] : counts_)
    if (count > most || (count == most && network < largest)) largest = network, most = count;
  return largest;
}

}  // namespace rigcal::http
