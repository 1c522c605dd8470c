// What depends on a board: sessions that name it, seen by a sensor or not, revisions that count them, robots.
#pragma once

#include <cstddef>
#include <vector>

#include "server/base/ids.h"
#include "server/base/stamp.h"

namespace rigcal {

struct TracedSession {
  SessionId session;
  Stamp captured_at;
  bool counts = true;  // now: neither retired nor superseded
};

struct TracedRobot {
  RobotId robot;
  std::vector<TracedSession> sessions;  // the oldest first
  // Revisions in which at least one of these sessions counted: that were made when a good edge of it was there and it
  // was neither retired nor superseded, ascending. Where a sensor was remounted since, little of it may be left.
  std::vector<int> revisions;
};

// By robot id. Only closed sessions are in it.
struct BoardTrace {
  std::vector<TracedRobot> robots;
  // In all, of all robots; those that do not count any more too.
  // Of all its robots together.
  [[nodiscard]] std::size_t sessions() const {
    std::size_t count = 0;
    for (const TracedRobot& one : robots) count += one.sessions.size();
    return count;
  }
  // Likewise; a number of one robot is not that of another.
  [[nodiscard]] std::size_t revisions() const {
    std::size_t count = 0;
    for (const TracedRobot& one : robots) count += one.revisions.size();
    return count;
  }
};

}  // namespace rigcal
