#include "server/calib/core/capture_blocks.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace rigcal::calib {
namespace {

constexpr std::size_t kIdMax = 64;  // characters, on the wire and in documents

std::string IdOf(const std::vector<CaptureId>& all, std::size_t first, std::size_t end, std::size_t group) {
  if (end - first == 1) return all[first].str();
  std::string id = all[first].str() + "-" + all[end - 1].str();
  return id.size() <= kIdMax ? id : "group " + std::to_string(group + 1) + " of " + std::to_string(kBlocksMax);
}

using InOrder = std::set<CaptureId, TakenBefore>;

// `count` of them, or all: one of each of so many stretches. The place in the stretch moves on by the golden ratio, so
// that captures that alternate between two places are all drawn from.
template <typename Each>
void ForSpread(const InOrder& captures, std::size_t count, const Each& each) {
  constexpr double kGolden = 0.6180339887498949;
  const std::vector<CaptureId> all(captures.begin(), captures.end());
  count = std::min(count, all.size());
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t first = k * all.size() / count, size = (k + 1) * all.size() / count - first;
    const double place = std::fmod(static_cast<double>(k) * kGolden, 1.0);
    each(all[first + static_cast<std::size_t>(place * static_cast<double>(size))]);
  }
}

}  // namespace

bool TakenBefore::operator()(const CaptureId& a, const CaptureId& b) const {
  return strverscmp(a.str().c_str(), b.str().c_str()) < 0;
}

std::vector<CaptureBlock> CaptureBlocks(const std::vector<CaptureId>& session, const std::set<CaptureId>& used) {
  std::set<CaptureId, TakenBefore> ordered(session.begin(), session.end());
  ordered.insert(used.begin(), used.end());
  const std::vector<CaptureId> all(ordered.begin(), ordered.end());
  const std::size_t groups = std::min(all.size(), kBlocksMax);
  std::vector<CaptureBlock> blocks;
  for (std::size_t group = 0; group < groups; ++group) {
    const std::size_t first = group * all.size() / groups, end = (group + 1) * all.size() / groups;
    CaptureBlock block{IdOf(all, first, end, group), {}};
    for (std::size_t i = first; i < end; ++i)
      if (used.contains(all[i])) block.captures.insert(all[i]);
    if (!block.captures.empty()) blocks.push_back(std::move(block));
  }
  return blocks;
}

std::vector<std::string> IdsOf(const std::vector<CaptureBlock>& blocks) {
  std::vector<std::string> ids;
  for (const CaptureBlock& block : blocks) ids.push_back(block.id);
  return ids;
}

std::size_t CountWith(const std::vector<CaptureBlock>& blocks, const std::set<CaptureId>& captures) {
  return static_cast<std::size_t>(std::count_if(blocks.begin(), blocks.end(), [&](const CaptureBlock& block) {
    return std::any_of(block.captures.begin(), block.captures.end(),
                       [&](const CaptureId& capture) { return captures.contains(capture); });
  }));
}

PairCaptures ChooseCaptures(const std::vector<CaptureId>& session, const std::set<CaptureId>& seen_by_both) {
  const InOrder all(session.begin(), session.end());
  PairCaptures chosen;
  const auto use = [&](const CaptureId& capture) { chosen.used.insert(capture); };
  ForSpread(all, all.size() <= kPairCapturesMax ? all.size() : kPairCapturesMax, use);
  InOrder more;
  for (const CaptureId& capture : seen_by_both)
    if (all.contains(capture) && !chosen.used.contains(capture)) more.insert(capture);
  const std::size_t used_by_both = seen_by_both.size() - more.size();
  if (used_by_both < kSeenByBothMin) ForSpread(more, kSeenByBothMin - used_by_both, use);
  for (const CaptureId& capture : all)
    if (!chosen.used.contains(capture)) chosen.left_out.insert(capture);
  return chosen;
}

}  // namespace rigcal::calib
