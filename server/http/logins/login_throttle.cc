#include "server/http/logins/login_throttle.h"

#include <algorithm>
#include <utility>

#include "server/http/connections/client_address.h"

namespace rigcal::http {
namespace {

constexpr std::size_t kKeptMax = 4096;  // of each kind; beyond, those that were left alone for longest are forgotten
constexpr std::chrono::minutes kTellEvery{1};

}  // namespace

void LoginThrottle::DropRested(Budgets& budgets, const Kind& kind, Time now) {
  const auto rests = [&](const auto& one) {
    return one.second.left + std::chrono::duration<double>(now - one.second.looked_at).count() * kind.per_s >=
           kind.at_once;
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

bool LoginThrottle::TryKnown(const std::string& browser, Time now) {
  const std::lock_guard lock(mutex_);
  Budget& budget = Refilled(of_browser_, browser, kOfAddress, now);
  if (budget.left < 1) return false;
  budget.left -= 1;
  return true;
}

void LoginThrottle::WasRight(const std::string& address) {
  const std::lock_guard lock(mutex_);
  if (const auto found = of_address_.find(NetworkOf(address)); found != of_address_.end()) found->second.left += 1;
}

void LoginThrottle::GiveBack(const std::string& address, const std::string& name) {
  WasRight(address);
  const std::lock_guard lock(mutex_);
  if (const auto found = of_name_.find(name); found != of_name_.end()) found->second.left += 1;
}

int LoginThrottle::CountToTell(const std::string& address, Time now) {
  const std::lock_guard lock(mutex_);
  const auto is_past = [now](const Untold& one) { return now - one.told_at >= kTellEvery; };
  if (untold_.size() >= kKeptMax) std::erase_if(untold_, [&](const auto& one) { return is_past(one.second); });
  const auto [found, is_new] = untold_.try_emplace(NetworkOf(address), Untold{0, now});
  Untold& untold = found->second;
  ++untold.count;
  if (!is_new && !is_past(untold)) return 0;
  untold.told_at = now;
  return std::exchange(untold.count, 0);
}

}  // namespace rigcal::http
