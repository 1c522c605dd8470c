#include "idl/reach.h"

#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>

#include <cstdlib>

namespace rigcal::wire {
namespace {

bool IsGiven(const char* variable) {
  const char* const value = std::getenv(variable);
  return value != nullptr && *value != 0;
}

}  // namespace

bool IsRuledFromOutside() { return IsGiven("CYCLONEDDS_URI"); }

bool IsOnlyHere() { return !IsRuledFromOutside() && IsGiven("RIGCAL_DDS_LOCAL"); }

bool HasNetwork() {
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return false;
  bool found = false;
  for (const ifaddrs* one = list; one != nullptr && !found; one = one->ifa_next) {
    const bool ipv4 = one->ifa_addr != nullptr && one->ifa_addr->sa_family == AF_INET;
    found = ipv4 && (one->ifa_flags & IFF_UP) != 0 && (one->ifa_flags & IFF_LOOPBACK) == 0;
  }
  freeifaddrs(list);
  return found;
}

bool ReachesOthers() { return IsRuledFromOutside() || (!IsOnlyHere() && HasNetwork()); }

}  // namespace rigcal::wire
