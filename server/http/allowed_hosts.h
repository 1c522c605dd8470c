// For whom a request may say that it came: a page of another site, whose name was pointed at this machine (DNS
// rebinding), names itself and is refused. Pure.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/base/result.h"

namespace rigcal::http {

// The names of this server: localhost, any address in digits (nobody can point one elsewhere), and those given.
class AllowedHosts {
 public:
  // Names of hosts, or addresses of pages ("https://rigs.example.org/rigcal"), in any case.
  explicit AllowedHosts(const std::vector<std::string>& names);
  // `authority`: "host", "host:port" or "[address]:port"; the port is not looked at. False for what is none.
  [[nodiscard]] bool Has(std::string_view authority) const;

 private:
  std::set<std::string> names_;
};

// kInvalidInput where `name` is none that a request could ever ask by ("*", say): AllowedHosts would do nothing with
// it.
[[nodiscard]] Status CheckHostName(const std::string& name);

// Those of a running server. Any thread.
class HostsInForce {
 public:
  explicit HostsInForce(AllowedHosts hosts) { Set(std::move(hosts)); }
  void Set(AllowedHosts hosts) {
    auto next = std::make_shared<const AllowedHosts>(std::move(hosts));
    const std::lock_guard lock(mutex_);
    hosts_ = std::move(next);
  }
  [[nodiscard]] std::shared_ptr<const AllowedHosts> Now() const {
    const std::lock_guard lock(mutex_);
    return hosts_;
  }

 private:
  mutable std::mutex mutex_;
  std::shared_ptr<const AllowedHosts> hosts_;
};

// What a browser in the same network calls a machine of this name: itself, its first label, and that below .local.
// Empty where it is no host's name.
[[nodiscard]] std::vector<std::string> NamesOfMachine(const std::string& machine);
// This machine alone is reached by it.
[[nodiscard]] bool IsLoopback(const std::string& host);

// What a request says of itself: every Host and Origin header, and its target as it came.
struct Caller {
  std::vector<std::string_view> hosts, origins;
  std::string_view target, version;
};
struct Refusal {
  int status = 0;
  Error error;
};
// 400: no Host or several. 421: another host's request. 403: a page of another site asks. Nothing: go on.
[[nodiscard]] std::optional<Refusal> RefusalOf(const AllowedHosts& allowed, const Caller& caller);

}  // namespace rigcal::http
