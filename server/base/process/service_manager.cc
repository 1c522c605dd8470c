#include "server/base/process/service_manager.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "server/base/files/file_descriptor.h"

namespace rigcal {
namespace {

std::int64_t NumberIn(const char* variable) {
  const char* text = std::getenv(variable);
  return text == nullptr ? 0 : std::strtoll(text, nullptr, 10);
}

}  // namespace

void TellServiceManager(std::string_view state) {
  const char* name = std::getenv("NOTIFY_SOCKET");
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (name == nullptr || std::strlen(name) >= sizeof address.sun_path) return;
  std::memcpy(address.sun_path, name, std::strlen(name));
  if (name[0] == '@') address.sun_path[0] = '\0';  // a name that is no file's
  const FileDescriptor socket(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + std::strlen(name));
  static_cast<void>(sendto(socket.get(), state.data(), state.size(), MSG_NOSIGNAL | MSG_DONTWAIT,
                           reinterpret_cast<const sockaddr*>(&address), size));
}

Watchdog::Watchdog() {
  const std::int64_t pid = NumberIn("WATCHDOG_PID");
  const std::int64_t wanted_us = pid == 0 || pid == getpid() ? NumberIn("WATCHDOG_USEC") : 0;
  if (wanted_us <= 0) return;
  every_ = std::chrono::microseconds(wanted_us / 2);
  TellServiceManager("WATCHDOG_USEC=" + std::to_string(wanted_us) + "\nWATCHDOG=1");
}

void Watchdog::HavePatience() {
  if (NumberIn("WATCHDOG_USEC") > 0) TellServiceManager("WATCHDOG_USEC=3600000000\nWATCHDOG=1");
}

void Watchdog::Turn(const Vitals& vitals) {
  const Time now = std::chrono::steady_clock::now();
  if (every_.count() == 0 || now < next_) return;
  const auto states = vitals.States(now);
  if (std::any_of(states.begin(), states.end(), [](const PartState& one) { return one.stands_still; })) return;
  TellServiceManager("WATCHDOG=1");
  next_ = now + every_;
}

}  // namespace rigcal
