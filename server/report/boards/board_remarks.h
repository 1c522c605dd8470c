// What the registry of boards says of a session's boards, on pages.
#pragma once

#include <vector>

#include "server/model/boards/remark.h"
#include "server/report/frame/page.h"

namespace rigcal::report {

// {{#BOARD_REMARK}} with LEVEL, WORD, WHY, CURE for each; the same words once, and of boards without a serial one.
void FillBoardRemarks(Dictionary& parent, const std::vector<BoardRemark>& remarks);

}  // namespace rigcal::report
