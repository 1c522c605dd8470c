// What `rigcal doctor` judges: each check is a line ok, warn or fail, with what to do. Judging is pure; looking is not.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace rigcal::client {

enum class CheckLevel { kOk, kWarn, kFail };
struct Check {
  std::string name;
  CheckLevel level = CheckLevel::kOk;
  std::string text;
  std::string cure;  // empty if ok
};
[[nodiscard]] std::string NameOf(CheckLevel level);  // "ok" | "warn" | "fail"

struct NetworkInterface {
  std::string name, address;
  bool is_loopback = false, has_multicast = false;
};
// Those that are up and have an IPv4 address.
[[nodiscard]] std::vector<NetworkInterface> ListInterfaces();
[[nodiscard]] Check JudgeInterfaces(const std::vector<NetworkInterface>& interfaces);

// The kernel's bound of a socket's receive buffer; nullopt if it can't be read.
[[nodiscard]] std::optional<std::int64_t> ReceiveBufferMax();
[[nodiscard]] Check JudgeReceiveBuffer(std::optional<std::int64_t> bytes_max);

// kFail where the protocols differ, kWarn where only the versions do. `server_protocol`: nothing where the server does
// not tell.
[[nodiscard]] Check JudgeVersions(const std::string& client, int client_protocol, const std::string& server,
                                  std::optional<std::int64_t> server_protocol);
// `offset_ns`: server minus here; `round_trip_ns` bounds its error.
[[nodiscard]] Check JudgeClock(std::int64_t offset_ns, std::int64_t round_trip_ns);
[[nodiscard]] Check JudgeRoundTrip(std::int64_t median_ns);
// `names`: the first of them, "mapper-01 left/01.png (damaged)".
[[nodiscard]] Check JudgeLostFiles(std::int64_t count, const std::vector<std::string>& names);
// `where`: "server's disk", "disk here".
[[nodiscard]] Check JudgeDisk(const std::string& where, std::optional<std::int64_t> free_bytes);

}  // namespace rigcal::client
