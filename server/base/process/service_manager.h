// What the service manager that started this process is told: systemd's protocol of sd_notify(3). Without one, nothing.
#pragma once

#include <chrono>
#include <string_view>

#include "server/base/process/vitals.h"

namespace rigcal {

// "READY=1", "STOPPING=1", ...; to the socket that NOTIFY_SOCKET names. What cannot be told is not.
void TellServiceManager(std::string_view state);

// systemd ends and starts a service anew that it hears nothing of for WatchdogSec. One thread.
class Watchdog {
 public:
  // How often it wants to hear is in the environment; from now on it waits no longer than that.
  Watchdog();
  // For what takes longer, once: an hour, or until another Watchdog is made.
  static void HavePatience();
  // Says that the process lives, twice as often as it has to, while no part of `vitals` stands still. Call it at least
  // once a second.
  void Turn(const Vitals& vitals);

 private:
  using Time = std::chrono::steady_clock::time_point;
  std::chrono::microseconds every_{0};  // 0: nobody wants to hear
  Time next_;
};

}  // namespace rigcal
