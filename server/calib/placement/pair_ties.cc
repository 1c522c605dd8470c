#include "server/calib/placement/pair_ties.h"

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

}  // namespace rigcal::calib::placement
