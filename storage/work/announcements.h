// What a process that shares its store wants told on the DDS networks of servers: each of them takes it from the store
// and tells it.
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

// It waits for each server that is there (servers.h), but for `sender`, which tells it itself. Where there is none it
// is told by nobody: an event is of the moment, and a state is told anew to whoever comes.
[[nodiscard]] Status AppendAnnouncement(Store& store, const WaitingAnnouncement& announcement,
                                        const std::string& sender = {});
// Those that wait for this server, in their order; they wait no more. Who ends before it told them has told nobody.
[[nodiscard]] Result<std::vector<WaitingAnnouncement>> TakeAnnouncements(Store& store, const std::string& server);

}  // namespace rigcal::storage
