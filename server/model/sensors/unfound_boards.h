// What is said of boards that no camera found in any picture, before a push and after it.
#pragma once

#include <string>
#include <vector>

#include "server/model/sensors/target.h"

namespace rigcal {

// Pictures that can be read, of one camera at least: of fewer a camera says nothing of a board.
inline constexpr int kPicturesToMissBoard = 3;

[[nodiscard]] std::string BoardName(const Target& board);  // "board calib"
// "board calib with 10 x 7 inner corners or board left with ...".
[[nodiscard]] std::string DescribedBoards(const std::vector<const Target*>& boards);
// Half a paragraph, without a stop at its end: the pictures may be dark, or the boards described wrong.
[[nodiscard]] std::string CureOfUnfoundBoards(const std::vector<const Target*>& boards);

}  // namespace rigcal
