// What came of an order: a change that a person asked for.
#pragma once

#include <string>

#include "server/base/ids.h"

namespace rigcal {

struct OrderDone {
  RobotId robot;  // to be revised
  std::string document;
  int decided = 0;  // revision about which somebody decided, so that the robot is told at once; 0: none
};

}  // namespace rigcal
