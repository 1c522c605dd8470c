// What the server tells of boards, for people.
#pragma once

#include <ostream>

#include "client/text/document.h"

namespace rigcal::client {

// Of the verb boards: the registry, then what sessions name and nobody measured.
void PrintBoardList(const Document& document, std::ostream& out);
// Of the verb board: what it is, then every check.
void PrintBoard(const Document& document, std::ostream& out);
// Of the verb board_trace: revisions by robot, then sessions.
void PrintBoardTrace(const Document& document, std::ostream& out);
// Of the order measure_board: its size from now on, and what rests on it.
void PrintBoardMeasured(const Document& document, std::ostream& out);
// "Board: ... (2 sessions). ...", a line for each different one of "board_remarks".
void PrintBoardRemarks(const Document& remarks, std::ostream& out);

}  // namespace rigcal::client
