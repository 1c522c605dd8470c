// What a pair's jackknife leaves out at once.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "server/base/ids.h"

namespace rigcal::calib {

constexpr std::size_t kBlocksMax = 40;

// Captures are named in the order in which they were taken, with leading zeros or without: "9" is before "10".
struct TakenBefore {
  bool operator()(const CaptureId& a, const CaptureId& b) const;
};

struct CaptureBlock {
  std::string id;                // the capture's, or "FIRST-LAST" of captures that follow one another; up to 64 characters
  std::set<CaptureId> captures;  // those of it that were used; never empty
};
// Of all captures of the session (where they are not told, of those used), kBlocksMax groups of nearly equal size that
// follow one another, a block each where they are no more; of each what is in `used`. All pairs of a session have the
// same groups, so that the graph can leave one out of all of them.
[[nodiscard]] std::vector<CaptureBlock> CaptureBlocks(const std::vector<CaptureId>& session,
                                                      const std::set<CaptureId>& used);
[[nodiscard]] std::vector<std::string> IdsOf(const std::vector<CaptureBlock>& blocks);
// How many of them have one of these captures: as often as the pair itself was seen independently.
[[nodiscard]] std::size_t CountWith(const std::vector<CaptureBlock>& blocks, const std::set<CaptureId>& captures);

}  // namespace rigcal::calib
