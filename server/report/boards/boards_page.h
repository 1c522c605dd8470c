// The registry of boards as a page, and what pages about sessions say of boards.
#pragma once

#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/formats/boards/answers.h"

namespace rigcal::report {

// /boards/: every board with its size, checks and sessions; then the serials that sessions name and nobody measured.
// `answer` may be a part of the registry: then the page says so.
[[nodiscard]] Result<std::string> RenderBoards(const formats::BoardsAnswer& answer);

// Of one board of a session, behind its name on reports and certificates: ", measured 24.987 x 25.01 mm (sigma 0.05) on
// 3 Nov 2026", ", not in the registry", ", check overdue". Empty: there is nothing to say.
[[nodiscard]] std::string StandardText(const SessionBoard& board, const BoardRegistry& registry,
                                       const std::vector<BoardRemark>& remarks);

}  // namespace rigcal::report
