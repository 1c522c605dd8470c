// What the registry of boards says of those that sessions used.
#pragma once

#include <vector>

#include "server/model/boards/remark.h"

namespace rigcal::fleet {

// In the order of `boards`. A board without a serial, one that nobody measured, and one whose check was due when the
// session was captured are marked; one that is another pattern, or whose stated size is farther from the measured one
// than three standard deviations of both allow, is a warning that names both. The newest measure holds for sessions
// of before as well: a board does not change its size when it is measured.
[[nodiscard]] std::vector<BoardRemark> RemarksOn(const std::vector<SessionBoard>& boards,
                                                 const BoardRegistry& registry);

}  // namespace rigcal::fleet
