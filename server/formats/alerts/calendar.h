// Work lists as a calendar (RFC 5545): one all-day event per robot, on the day by which it is due. Any calendar program
// can subscribe to it: a robot keeps its event when its date moves.
#pragma once

#include <string>
#include <vector>

#include "server/base/stamp.h"

namespace rigcal::formats {

struct CalendarEntry {
  std::string uid;   // the same for ever
  Stamp day;         // any moment of it, UTC
  Stamp known_at;    // when what it says was found out: DTSTAMP, so that the same data are the same bytes
  int sequence = 0;  // grows whenever the entry may have changed
  std::string summary, description, location;  // any text; an empty location is left out
};
// Lines of at most 75 octets, folded between characters, ended by CR LF; texts escaped, and what is no UTF-8 or a
// control character replaced by '?'.
[[nodiscard]] std::string WriteCalendar(const std::string& name, const std::vector<CalendarEntry>& entries);

}  // namespace rigcal::formats
