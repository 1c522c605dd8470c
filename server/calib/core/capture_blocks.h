// Of a session's captures: which of very many a pair uses, and what its jackknife leaves out at once.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "server/base/ids.h"

namespace rigcal::calib {

constexpr std::size_t kBlocksMax = 40;

// Captures are named in the order in which they were taken, with leading zeros or without: "9" is before "10".
struct TakenBefore {
  // By the numbers within the names, as strverscmp compares.
  bool operator()(const CaptureId& a, const CaptureId& b) const;
};

struct CaptureBlock {
  std::string id;  // the capture's, or "FIRST-LAST" of captures that follow one another; up to 64 characters
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

constexpr std::size_t kPairCapturesMax = 120;  // of the session, the same for all its pairs
constexpr std::size_t kSeenByBothMin = 60;     // a pair that has fewer of them uses more of its own, up to these

struct PairCaptures {
  std::set<CaptureId> used, left_out;  // of `session`
};

// Spread over the session in the order in which captures were taken, one of each of kPairCapturesMax stretches, at a
// place in it that does not repeat from stretch to stretch; a session that is not told, or has no more captures, is
// used whole.
[[nodiscard]] PairCaptures ChooseCaptures(const std::vector<CaptureId>& session,
                                          const std::set<CaptureId>& seen_by_both);

// Of a problem with a list of `captures`: all, or those of which `is_so`.
template <typename Problem, typename IsSo>
std::set<CaptureId> CapturesOf(const Problem& problem, const IsSo& is_so) {
  std::set<CaptureId> captures;
  for (const auto& capture : problem.captures)
    if (is_so(capture)) captures.insert(capture.capture);
  return captures;
}
template <typename Problem>
std::set<CaptureId> CapturesOf(const Problem& problem) {
  return CapturesOf(problem, [](const auto&) { return true; });
}
// Those at these of its indices.
template <typename Problem>
std::set<CaptureId> CapturesAt(const Problem& problem, const std::vector<std::size_t>& indices) {
  std::set<CaptureId> captures;
  for (const std::size_t idx : indices) captures.insert(problem.captures[idx].capture);
  return captures;
}
// From vectors that run side by side.
template <typename... Vectors>
void EraseAt(std::size_t position, Vectors&... vectors) {
  (vectors.erase(vectors.begin() + static_cast<std::ptrdiff_t>(position)), ...);
}
template <typename Problem>
void DropCaptures(Problem& problem, const std::set<CaptureId>& left_out) {
  std::erase_if(problem.captures, [&](const auto& capture) { return left_out.contains(capture.capture); });
}

}  // namespace rigcal::calib
