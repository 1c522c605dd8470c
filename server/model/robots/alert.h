// What people and their programs are told when something changed: kept until every receiver has it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/base/ids.h"
#include "server/base/stamp.h"

namespace rigcal {

// Kinds: "status", "approved", "rejected", "rolled_back", "session_failed".
struct Alert {
  std::int64_t number = 0;  // order in which they happened, among those of all robots
  Digest id;                // the same whenever it is sent again
  RobotId robot;
  std::string kind;
  std::string subject;  // the status, the number of the revision, the session
  Stamp at;
  std::string body;  // JSON (formats/alerts/alert_body.h)
};

// That waits for one receiver, with what became of it until now.
struct WaitingAlert {
  Alert alert;
  int attempts = 0;
};

// A receiver, and what waits for it.
struct ReceiverState {
  std::string url;       // without what follows '?', which may be a secret
  bool is_told = false;  // of what happens now; false: it is not in the configuration any more
  std::int64_t waiting = 0, delivered = 0;
  std::optional<Stamp> oldest_at = {};    // that waits: when it happened
  int attempts = 0;                       // at that which was tried most often
  std::optional<Stamp> next_try_at = {};  // the soonest; absent: nothing waits, or at once
  std::string last_error = {};            // of those that wait, the newest that was tried; empty: none failed
};

}  // namespace rigcal
