#include "server/base/process/leave_soon.h"

#include <chrono>
#include <cstdlib>
#include <thread>

#include "server/base/log.h"

namespace rigcal {

void LeaveSoon() {
  constexpr std::chrono::seconds kGrace{20};
  std::thread([kGrace] {
    std::this_thread::sleep_for(kGrace);
    LogWarn("stopped amid unfinished work: the next start does it anew");
    std::_Exit(0);
  }).detach();
}

}  // namespace rigcal
