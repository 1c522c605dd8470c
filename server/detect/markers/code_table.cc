#include "server/detect/markers/code_table.h"

#include <bit>
#include <cstddef>
#include <utility>

namespace rigcal::detect {

CodeTable::CodeTable(std::vector<std::array<CodeBits, 4>> codes, int wrong_bits_max)
    : codes_(std::move(codes)), wrong_bits_max_(wrong_bits_max) {}

std::optional<int> CodeTable::IdOf(CodeBits code) const {
  for (std::size_t id = 0; id < codes_.size(); ++id)
    for (const CodeBits turned : codes_[id])
      if (std::popcount(code ^ turned) <= wrong_bits_max_) return static_cast<int>(id);
  return std::nullopt;
}

}  // namespace rigcal::detect
