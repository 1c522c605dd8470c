#include "server/dds/record/byte_ranges.h"

#include <algorithm>
#include <iterator>

namespace rigcal::dds {

std::vector<ByteRange> ByteRanges::Add(ByteRange range) {
  std::vector<ByteRange> fresh;
  if (range.begin >= range.end) return fresh;
  auto next = end_by_begin_.upper_bound(range.begin);
  if (next != end_by_begin_.begin() && std::prev(next)->second >= range.begin) --next;
  ByteRange merged = range;
  std::uint64_t at = range.begin;
  while (next != end_by_begin_.end() && next->first <= range.end) {
    if (at < next->first) fresh.push_back({at, next->first});
    at = std::max(at, next->second);
    merged = {std::min(merged.begin, next->first), std::max(merged.end, next->second)};
    next = end_by_begin_.erase(next);
  }
  if (at < range.end) fresh.push_back({at, range.end});
  end_by_begin_.emplace(merged.begin, merged.end);
  return fresh;
}

bool ByteRanges::CoversUpTo(std::uint64_t end) const {
  const auto first = end_by_begin_.find(0);
  return end == 0 || (first != end_by_begin_.end() && first->second >= end);
}

}  // namespace rigcal::dds
