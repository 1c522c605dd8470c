// The boards of a session, and what the registry of boards has to say of them.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "server/model/boards/measure.h"

namespace rigcal {

// A target of a closed session, as its session.yaml says.
struct SessionBoard {
  SessionId session;
  Stamp captured_at;
  TargetId target;
  std::string serial;  // empty: it has none
  BoardPattern pattern;
  double square_sigma_m = 0.0;  // as stated; 0: taken as exact
};

// The newest measure of each board, by serial.
using BoardRegistry = std::map<std::string, BoardMeasure>;

// A session is used all the same: people are told what it rests on.
struct BoardRemark {
  SessionId session;
  TargetId target;
  std::string serial;
  std::string code;         // "no_serial", "unknown_serial", "check_overdue", "other_pattern", "other_size"
  bool is_warning = false;  // the session contradicts the registry
  std::string what, cure;   // sentences; `what` without a stop
};

}  // namespace rigcal
