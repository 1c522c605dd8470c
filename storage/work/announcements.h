// What a process that is not on DDS wants told there: whoever serves takes it from the store and tells it.
#pragma once

#include <string>
#include <vector>

#include "server/base/ids.h"
#include "server/base/stamp.h"
#include "storage/store.h"

namespace rigcal::storage {

struct WaitingAnnouncement {
  RobotId robot;
  std::string kind;  // of an event (Event::kind); empty: what is stored of the robot's calibration is another
  std::string subject, json;
  Stamp at;
};

[[nodiscard]] Status AppendAnnouncement(Store& store, const WaitingAnnouncement& announcement);
// Those that wait, in their order; they wait no more. Who ends before it told them has told nobody: an event is of the
// moment, and a state is told anew to whoever comes.
[[nodiscard]] Result<std::vector<WaitingAnnouncement>> TakeAnnouncements(Store& store);

}  // namespace rigcal::storage
