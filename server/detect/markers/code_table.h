// The codes of a dictionary of markers as bits in a word: quick to compare with what many squares show.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace rigcal::detect {

// A code's bits row by row; at most 8 x 8.
using CodeBits = std::uint64_t;

class CodeTable {
 public:
  // `codes` in all four turns, in the order of their ids.
  CodeTable(std::vector<std::array<CodeBits, 4>> codes, int wrong_bits_max);
  // The first id whose code has at most so many other bits in any turn: as OpenCV's Dictionary::identify().
  [[nodiscard]] std::optional<int> IdOf(CodeBits code) const;

 private:
  std::vector<std::array<CodeBits, 4>> codes_;
  int wrong_bits_max_;
};

}  // namespace rigcal::detect
