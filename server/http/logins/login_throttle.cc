#include "server/http/logins/login_throttle.h"

#include <algorithm>

#include "server/http/networks.h"

namespace rigcal::http {
namespace {

constexpr std::size_t kKeptMax = 4096;  // of each kind; beyond, those that were left alone for longest are forgotten

}  // namespace

void LoginThrottle::DropRested(Budgets& budgets, const Kind& kind, Time now) {
  const auto rests = [&](const auto& one) {
    return one.second.left + std::chrono::duration<double>(now - one.second.looked_at).count() * kind.per_s >= kind.at_once;
  };
  std::erase_if(budgets, rests);
  if (budgets.size() < kKeptMax) return;
  budgets.erase(std::min_element(budgets.begin(), budgets.end(),
                                 [](const auto& a, const auto& b) { return a.second.looked_at < b.second.looked_at; }));
}

LoginThrottle::Budget& LoginThrottle::Refilled(Budgets& budgets, const std::string& key, const Kind& kind, Time now) {
  if (budgets.size() >= kKeptMax && budgets.count(key) == 0) DropRested(budgets, kind, now);
  Budget& budget = budgets.try_emplace(key, Budget{kind.at_once, now}).first->second;
  const double rested_s = std::chrono::duration<double>(now - budget.looked_at).count();
  budget = {std::min(kind.at_once, budget.left + rested_s * kind.per_s), now};
  return budget;
}

bool LoginThrottle::Try(const std::string& address, const std::string& name, Time now) {
  const std::lock_guard lock(mutex_);
  Budget& of_address = Refilled(of_address_, NetworkOf(address), kOfAddress, now);
  Budget& of_name = Refilled(of_name_, name, kOfName, now);
  if (of_address.left < 1 || of_name.left < 1) return false;
  of_address.left -= 1;
  of_name.left -= 1;
  return true;
}

void LoginThrottle::WasRight(const std::string& address, const std::string& name) {
  const std::lock_guard lock(mutex_);
  if (const auto found = of_address_.find(NetworkOf(address)); found != of_address_.end()) found->second.left += 1;
  if (const auto found = of_name_.find(name); found != of_name_.end()) found->second.left += 1;
}

}  // namespace rigcal::http
