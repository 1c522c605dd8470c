#include "client/ask/checks.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>

#include "client/text/table.h"

namespace rigcal::client {
namespace {

constexpr std::int64_t kBufferWanted_bytes = 4 << 20;  // deploy/dds/default.xml
constexpr std::int64_t kClockGood_ns = 100'000'000;
constexpr std::int64_t kRoundTripGood_ns = 50'000'000;
constexpr double kDiskWarn_bytes = 10e9, kDiskFail_bytes = 1e9;

std::string Milliseconds(std::int64_t ns) { return Fixed(static_cast<double>(ns) * 1e-6, 1) + " ms"; }

std::string AddressOf(const sockaddr& address) {
  std::array<char, INET_ADDRSTRLEN> text{};
  const auto& ipv4 = reinterpret_cast<const sockaddr_in&>(address);
  return inet_ntop(AF_INET, &ipv4.sin_addr, text.data(), text.size()) ? text.data() : "?";
}

}  // namespace

std::string NameOf(CheckLevel level) {
  return level == CheckLevel::kOk ? "ok" : level == CheckLevel::kWarn ? "warn" : "fail";
}

std::vector<NetworkInterface> ListInterfaces() {
  std::vector<NetworkInterface> found;
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return found;
  for (const ifaddrs* one = list; one != nullptr; one = one->ifa_next) {
    if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != AF_INET || (one->ifa_flags & IFF_UP) == 0) continue;
    found.push_back({one->ifa_name, AddressOf(*one->ifa_addr), (one->ifa_flags & IFF_LOOPBACK) != 0,
                     (one->ifa_flags & IFF_MULTICAST) != 0});
  }
  freeifaddrs(list);
  return found;
}

Check JudgeInterfaces(const std::vector<NetworkInterface>& interfaces) {
  std::string text;
  bool has_network = false, has_multicast = false;
  for (const NetworkInterface& one : interfaces) {
    text += (text.empty() ? "" : ", ") + one.name + " " + one.address + (one.has_multicast ? " (multicast)" : "");
    has_network = has_network || !one.is_loopback;
    has_multicast = has_multicast || (!one.is_loopback && one.has_multicast);
  }
  if (interfaces.empty())
    return {"network", CheckLevel::kFail, "no interface is up", "Bring up at least the loopback: `ip link set lo up`"};
  if (!has_network)
    return {"network", CheckLevel::kWarn, text + ": only this machine is reachable",
            "Connect the network if rigcald runs elsewhere"};
  if (!has_multicast)
    return {"network", CheckLevel::kWarn,
            text + ": no multicast, servers on other machines are not found by themselves",
            "`ip link set DEV multicast on`, or name the server as a peer through CYCLONEDDS_URI"};
  return {"network", CheckLevel::kOk, text, ""};
}

std::optional<std::int64_t> ReceiveBufferMax() {
  std::ifstream file("/proc/sys/net/core/rmem_max");
  std::int64_t bytes = 0;
  if (file >> bytes) return bytes;
  return std::nullopt;
}

Check JudgeReceiveBuffer(std::optional<std::int64_t> bytes_max) {
  if (!bytes_max)
    return {"socket buffer", CheckLevel::kWarn, "net.core.rmem_max cannot be read", "Run on Linux with /proc mounted"};
  const std::string text = "net.core.rmem_max is " + ByteText(static_cast<double>(*bytes_max)) + ", wanted " +
                           ByteText(static_cast<double>(kBufferWanted_bytes));
  if (*bytes_max >= kBufferWanted_bytes) return {"socket buffer", CheckLevel::kOk, text, ""};
  return {"socket buffer", CheckLevel::kWarn, text + ": pushes work, but slower under load",
          "`sysctl -w net.core.rmem_max=4194304 net.core.wmem_max=4194304`, on the server too"};
}

Check JudgeVersions(const std::string& client, int client_protocol, const std::string& server,
                    std::optional<std::int64_t> server_protocol) {
  const std::string text = "rigcal " + client + " (protocol " + std::to_string(client_protocol) + "), rigcald " +
                           server + " (protocol " + (server_protocol ? std::to_string(*server_protocol) : "?") + ")";
  if (server_protocol != client_protocol)
    return {"versions", CheckLevel::kFail, text,
            "Install the same version of rigcal here and of rigcald on the server"};
  if (client != server)
    return {"versions", CheckLevel::kWarn, text, "They understand each other; install the same version when you can"};
  return {"versions", CheckLevel::kOk, text, ""};
}

Check JudgeClock(std::int64_t offset_ns, std::int64_t round_trip_ns) {
  const std::string text = "the server's clock is " + Milliseconds(std::abs(offset_ns)) +
                           (offset_ns >= 0 ? " ahead" : " behind") + " (+- " + Milliseconds(round_trip_ns / 2) + ")";
  if (std::abs(offset_ns) <= kClockGood_ns + round_trip_ns / 2) return {"clock", CheckLevel::kOk, text, ""};
  return {"clock", CheckLevel::kWarn, text + ": ages and due dates are off by as much",
          "Let both machines follow the same time server (chrony or systemd-timesyncd)"};
}

Check JudgeRoundTrip(std::int64_t median_ns) {
  const std::string text = "a question and its answer take " + Milliseconds(median_ns);
  if (median_ns <= kRoundTripGood_ns) return {"round trip", CheckLevel::kOk, text, ""};
  return {"round trip", CheckLevel::kWarn, text, "Look at the server's load, and at the network between"};
}

Check JudgeLostFiles(std::int64_t count, const std::vector<std::string>& names) {
  if (count == 0) return {"stored files", CheckLevel::kOk, "none is known to be damaged or missing", ""};
  std::string text = std::to_string(count) + (count == 1 ? " is" : " are") + " not as pushed:";
  for (const std::string& name : names) text += (&name == &names.front() ? " " : ", ") + name;
  if (static_cast<std::size_t>(count) > names.size()) text += ", ...";
  return {"stored files", CheckLevel::kFail, text,
          "Push their sessions again: only these files are sent. Check the server's disk"};
}

Check JudgeDisk(const std::string& where, std::optional<std::int64_t> free_bytes) {
  if (!free_bytes) return {where, CheckLevel::kWarn, "free space is not known", "Look at it by hand with `df -h`"};
  const auto bytes = static_cast<double>(*free_bytes);
  const std::string text = ByteText(bytes) + " free";
  if (bytes >= kDiskWarn_bytes) return {where, CheckLevel::kOk, text, ""};
  return {where, bytes < kDiskFail_bytes ? CheckLevel::kFail : CheckLevel::kWarn, text,
          "Make room before the next session"};
}

}  // namespace rigcal::client
