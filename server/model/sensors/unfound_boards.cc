#include "server/model/sensors/unfound_boards.h"

#include <algorithm>

namespace rigcal {
namespace {

std::string CountsOf(const Target& board) {
  return std::to_string(board.cols) + " x " + std::to_string(board.rows) + " " + CountedOf(board.kind);
}

template <typename TextOf>
std::string JoinedByOr(const std::vector<const Target*>& boards, const TextOf& text_of) {
  std::string text;
  for (const Target* board : boards) text += (text.empty() ? "" : " or ") + text_of(*board);
  return text;
}

const char* WhatToCount(const std::vector<const Target*>& boards) {
  const auto any = [&](const auto& is_so) { return std::any_of(boards.begin(), boards.end(), is_so); };
  if (any([](const Target* board) { return !board->dictionary.empty(); }))
    return "tags, check its dictionary and correct both";
  if (any([](const Target* board) { return IsCircleGrid(board->kind); }))
    return "circles, and correct `circles`, `spacing_m` and `diameter_m`";
  return "inner corners and correct `inner_corners`";
}

}  // namespace

std::string BoardName(const Target& board) { return "board " + board.id.str(); }

std::string DescribedBoards(const std::vector<const Target*>& boards) {
  return JoinedByOr(boards, [](const Target& board) { return BoardName(board) + " with " + CountsOf(board); });
}

std::string CureOfUnfoundBoards(const std::vector<const Target*>& boards) {
  return "Open one of the pictures. It is dark, or without " + JoinedByOr(boards, BoardName) +
         ": take caps off the lenses, light the board, capture again. The board is there: count its " +
         WhatToCount(boards) + " in session.yaml";
}

}  // namespace rigcal
