// What came of an order: a change that a person asked for.
#pragma once

#include <string>

#include "server/base/ids.h"

namespace rigcal {

// By what way an order came: over HTTP only of who logged in, or has a token.
enum class OrderChannel { kHttp, kDds };

struct OrderDone {
  RobotId robot;  // to be revised
  std::string document;
  int decided = 0;  // revision about which somebody decided, so that the robot is told at once; 0: none
};

}  // namespace rigcal
