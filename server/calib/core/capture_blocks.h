// What a pair's jackknife leaves out at once.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "server/base/ids.h"

namespace rigcal::calib {

constexpr std::size_t kBlocksMax = 40;

struct CaptureBlock {
  std::string id;                // the capture's, or "FIRST-LAST" of captures that follow one another
  std::set<CaptureId> captures;  // those of it that were used; never empty
};
// Of `all` captures that the pair knows, in their order, kBlocksMax groups of nearly equal size that follow one another (a
// block each where they are no more); of each what is in `used`. Pairs that know the same captures have the same groups,
// so that the graph can leave one out of all of them.
[[nodiscard]] std::vector<CaptureBlock> CaptureBlocks(const std::vector<CaptureId>& all, const std::set<CaptureId>& used);
[[nodiscard]] std::vector<std::string> IdsOf(const std::vector<CaptureBlock>& blocks);

}  // namespace rigcal::calib
