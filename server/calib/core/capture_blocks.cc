#include "server/calib/core/capture_blocks.h"

#include <algorithm>

namespace rigcal::calib {
namespace {

std::string IdOf(const std::vector<CaptureId>& all, std::size_t first, std::size_t end) {
  return end - first == 1 ? all[first].str() : all[first].str() + "-" + all[end - 1].str();
}

}  // namespace

std::vector<CaptureBlock> CaptureBlocks(const std::vector<CaptureId>& all, const std::set<CaptureId>& used) {
  const std::size_t groups = std::min(all.size(), kBlocksMax);
  std::vector<CaptureBlock> blocks;
  for (std::size_t group = 0; group < groups; ++group) {
    const std::size_t first = group * all.size() / groups, end = (group + 1) * all.size() / groups;
    CaptureBlock block{IdOf(all, first, end), {}};
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

}  // namespace rigcal::calib
