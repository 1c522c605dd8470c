#include "server/http/connections/client_address.h"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <algorithm>
#include <array>

namespace rigcal::http {
namespace {

constexpr std::string_view kOfOldKind = "::ffff:", kBlanks = " \t";

std::optional<std::string> TextIn(int family, const std::string& digits) {
  in6_addr address{};  // larger than one of IPv4
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (inet_pton(family, digits.c_str(), &address) != 1) return std::nullopt;
  return std::string(inet_ntop(family, &address, text.data(), text.size()));
}

std::string_view LastEntry(std::string_view header) {
  header.remove_prefix(std::min(header.rfind(',') + 1, header.size()));
  const std::size_t first = header.find_first_not_of(kBlanks);
  return first == std::string_view::npos ? std::string_view()
                                         : header.substr(first, header.find_last_not_of(kBlanks) - first + 1);
}

}  // namespace

std::optional<std::string> PlainAddress(std::string_view text) {
  if (text.size() > 2 && text.front() == '[' && text.back() == ']') text = text.substr(1, text.size() - 2);
  const std::string digits(text);
  if (auto four = TextIn(AF_INET, digits)) return four;
  const auto six = TextIn(AF_INET6, digits);
  if (!six || six->rfind(kOfOldKind, 0) != 0) return six;
  const auto four = TextIn(AF_INET, six->substr(kOfOldKind.size()));
  return four ? four : six;
}

std::string ClientAddress(const std::string& remote, const std::string& proxy,
                          const std::vector<std::string_view>& forwarded_for) {
  if (proxy.empty() || forwarded_for.empty() || PlainAddress(remote) != PlainAddress(proxy)) return remote;
  return PlainAddress(LastEntry(forwarded_for.back())).value_or(remote);
}

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
