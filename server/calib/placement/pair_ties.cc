#include "server/calib/placement/pair_ties.h"

#include "server/model/edges/pair_loops.h"

namespace rigcal::calib::placement {

void PairTies::Add(const PlannedCapture& capture) {
  for (const PlannedLook& a : capture.looks)
    for (const PlannedLook& b : capture.looks)
      if (a.camera != b.camera) ++together_[a.camera * cameras_ + b.camera];
}

std::vector<int> PairTies::TiedBy(std::size_t reference, int wanted) const {
  std::vector<int> tied(cameras_, 0);
  for (int level = 1; level <= wanted; ++level) {
    std::vector<std::size_t> reached = {reference};
    tied[reference] = level;
    for (std::size_t at = 0; at < reached.size(); ++at)
      for (std::size_t next = 0; next < cameras_; ++next)
        if (tied[next] < level && Together(reached[at], next) >= level) {
          tied[next] = level;
          reached.push_back(next);
        }
  }
  return tied;
}

std::vector<UntestedPair> PairTies::Untested(const PlannedRig& rig) const {
  std::vector<PairOfSession> pairs;
  for (const auto& [a, b] : rig.pairs) pairs.push_back({a, b, Together(a, b) >= kSharedCapturesMin});
  const std::vector<bool> in_loop = AreInLoops(pairs);
  std::vector<UntestedPair> untested;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const int lacking = rig.captures_to_test - Together(pairs[i].a, pairs[i].b);
    if (in_loop[i] && lacking > 0) untested.push_back({pairs[i].a, pairs[i].b, lacking});
  }
  return untested;
}

}  // namespace rigcal::calib::placement
