#include "server/http/allowed_hosts.h"

#include <arpa/inet.h>

#include <algorithm>

#include "server/base/text.h"

namespace rigcal::http {
namespace {

constexpr std::string_view kNameCharacters = "0123456789abcdefghijklmnopqrstuvwxyz.-_";
constexpr std::size_t kNameBytesMax = 253;  // of DNS

bool IsPort(std::string_view text) {
  return text.size() <= 5 && text.find_first_not_of("0123456789") == std::string_view::npos;
}

// In small letters, without port and the root's dot; "[...]" for IPv6. Empty where it is none.
std::string HostOf(std::string_view authority) {
  const std::size_t bracket = authority.substr(0, 1) == "[" ? authority.find(']') : 0;
  if (bracket == std::string_view::npos) return "";
  const std::size_t end = std::min(authority.find(':', bracket), authority.size());
  if (end < authority.size() && !IsPort(authority.substr(end + 1))) return "";
  std::string host(authority.substr(0, end));
  std::transform(host.begin(), host.end(), host.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  if (host.size() > 1 && host.back() == '.') host.pop_back();
  return host;
}

bool IsAddress(const std::string& host) {
  in_addr four{};
  in6_addr six{};
  if (host.size() < 2 || host.front() != '[' || host.back() != ']') return inet_pton(AF_INET, host.c_str(), &four) == 1;
  return inet_pton(AF_INET6, host.substr(1, host.size() - 2).c_str(), &six) == 1;
}

bool IsName(const std::string& host) {
  return !host.empty() && host.size() <= kNameBytesMax && host.find_first_not_of(kNameCharacters) == std::string::npos;
}

// What stands between "http://" and the path; nothing for other schemes.
std::optional<std::string_view> AuthorityOf(std::string_view url) {
  for (const std::string_view scheme : {"http://", "https://"})
    if (url.substr(0, scheme.size()) == scheme) {
      url.remove_prefix(scheme.size());
      return url.substr(0, url.find('/'));
    }
  return std::nullopt;
}

Refusal OtherHost(std::string_view authority) {
  const std::string host = HostOf(authority);
  const std::string name = IsName(host) ? host : "NAME";
  return {421,
          {ErrorCode::kInvalidInput, "this server is not known as " + Quoted(authority),
           "Ask for it by its address in digits or its machine's name; if this name is right too, start rigcald with "
           "`--http-name " +
               name + "`"}};
}

Refusal OtherSite(std::string_view origin) {
  return {403,
          {ErrorCode::kInvalidInput, "a page of " + Quoted(origin) + " may not ask this server",
           "Open the server's own pages; programs send no Origin; for a name of this server give `--http-name NAME`"}};
}

Refusal NoHost(std::size_t count) {
  return {400,
          {ErrorCode::kInvalidInput, "the request has " + std::to_string(count) + " Host headers instead of one",
           "Send `Host: NAME:PORT` once"}};
}

}  // namespace

AllowedHosts::AllowedHosts(const std::vector<std::string>& names) : names_{"localhost"} {
  for (const std::string& name : names)
    if (const std::string host = HostOf(AuthorityOf(name).value_or(name)); !host.empty()) names_.insert(host);
}

Status CheckHostName(const std::string& name) {
  const std::string host = HostOf(AuthorityOf(name).value_or(name));
  if (IsName(host) || IsAddress(host)) return {};
  return Fail(ErrorCode::kInvalidInput, "--http-name " + Quoted(name) + " is no name of a host",
              "Give each name that browsers ask for as it is, rigs.example.org say; none stands for several.");
}

bool AllowedHosts::Has(std::string_view authority) const {
  const std::string host = HostOf(authority);
  return names_.count(host) > 0 || IsAddress(host);
}

std::vector<std::string> NamesOfMachine(const std::string& machine) {
  const std::string name = HostOf(machine);
  const std::string first = name.substr(0, name.find('.'));
  if (!IsName(name) || first.empty()) return {};
  return {name, first, first + ".local"};
}

bool IsLoopback(const std::string& host) {
  const std::string name = HostOf(host);
  return name == "localhost" || name == "[::1]" || (name.rfind("127.", 0) == 0 && IsAddress(name));
}

std::optional<Refusal> RefusalOf(const AllowedHosts& allowed, const Caller& caller) {
  const bool may_lack_it = caller.version == "1.0";
  if (caller.hosts.size() > 1 || (caller.hosts.empty() && !may_lack_it)) return NoHost(caller.hosts.size());
  for (const std::string_view host : caller.hosts)
    if (!allowed.Has(host)) return OtherHost(host);
  if (const auto authority = AuthorityOf(caller.target); authority && !allowed.Has(*authority))
    return OtherHost(*authority);
  for (const std::string_view origin : caller.origins) {
    const auto authority = AuthorityOf(origin);
    if (!authority || !allowed.Has(*authority)) return OtherSite(origin);
  }
  return std::nullopt;
}

}  // namespace rigcal::http
