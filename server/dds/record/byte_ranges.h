// Which bytes of a payload have arrived.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

namespace rigcal::dds {

struct ByteRange {
  std::uint64_t begin = 0, end = 0;
  friend bool operator==(const ByteRange&, const ByteRange&) = default;
};

class ByteRanges {
 public:
  // Covers `range`; the parts of it that were not covered before, ascending.
  std::vector<ByteRange> Add(ByteRange range);
  [[nodiscard]] bool CoversUpTo(std::uint64_t end) const;  // [0, end) without a gap
  [[nodiscard]] std::size_t pieces() const { return end_by_begin_.size(); }

 private:
  std::map<std::uint64_t, std::uint64_t> end_by_begin_;  // disjoint, not touching
};

}  // namespace rigcal::dds
