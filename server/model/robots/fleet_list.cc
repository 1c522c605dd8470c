#include "server/model/robots/fleet_list.h"

namespace rigcal {

// The first of all days, 1970-01-01, was a Thursday.
Stamp NextMonday(Stamp now) {
  constexpr std::int64_t kFirstMonday_ns = kWeek_ns / 7 * 4;
  const std::int64_t into_week_ns = ((now.ns - kFirstMonday_ns) % kWeek_ns + kWeek_ns) % kWeek_ns;
  return Stamp{now.ns - into_week_ns + kWeek_ns};
}

}  // namespace rigcal
