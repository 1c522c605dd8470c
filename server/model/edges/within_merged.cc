#include "server/model/edges/within_merged.h"

namespace rigcal {

std::string WithinCommand(const RobotId& robot, const EdgeId& merged) {
  constexpr std::size_t kDigitsTyped = 16;
  return "rigcal edges " + robot.str() + " --in " + merged.str().substr(0, kDigitsTyped);
}

}  // namespace rigcal
