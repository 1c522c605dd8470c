// How often passwords may be tried, and how often the log says that they were not looked at. Any thread.
#pragma once

#include <chrono>
#include <mutex>
#include <string>
#include <unordered_map>

namespace rigcal::http {

// From one address 5 at once, then one every 12 s; of one name from all addresses together 20 at once, then one every 3
// s. A password that was right costs of the name's alone: so many logins a minute, and no more.
class LoginThrottle {
 public:
  using Time = std::chrono::steady_clock::time_point;
  // Counts a try. False: not now. Of an IPv6 address the first half counts: whoever has one has all of them.
  [[nodiscard]] bool Try(const std::string& address, const std::string& name, Time now);
  // Counts a try of a browser in which this name logged in before: 5 at once, then one every 12 s, whatever address and
  // name have left. It costs them nothing.
  [[nodiscard]] bool TryKnown(const std::string& browser, Time now);
  void WasRight(const std::string& address);
  // It was not looked at: that costs nothing.
  void GiveBack(const std::string& address, const std::string& name);
  // Of tries that were refused: how many of this address the log is to tell of now, which is at most once a minute; 0:
  // none.
  [[nodiscard]] int CountToTell(const std::string& address, Time now);

 private:
  struct Kind {
    double at_once, per_s;
  };
  struct Budget {
    double left;
    Time looked_at;
  };
  struct Untold {
    int count;
    Time told_at;
  };
  using Budgets = std::unordered_map<std::string, Budget>;
  static constexpr Kind kOfAddress{5, 1.0 / 12}, kOfName{20, 1.0 / 3};

  static Budget& Refilled(Budgets& budgets, const std::string& key, const Kind& kind, Time now);
  static void DropRested(Budgets& budgets, const Kind& kind, Time now);

  std::mutex mutex_;
  Budgets of_address_, of_name_, of_browser_;
  std::unordered_map<std::string, Untold> untold_;  // by address
};

}  // namespace rigcal::http
