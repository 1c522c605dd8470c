#include "server/model/edges/pair_loops.h"

#include <set>

namespace rigcal {
namespace {

// Whether other pairs lead from one of its sensors to the other.
bool IsInLoop(std::size_t at, const std::vector<PairOfSession>& pairs) {
  std::set<std::size_t> reached = {pairs[at].a};
  for (bool more = true; more;) {
    more = false;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const PairOfSession& other = pairs[i];
      if (i == at || !other.is_whole || reached.contains(other.a) == reached.contains(other.b)) continue;
      reached.insert({other.a, other.b});
      more = true;
    }
  }
  return reached.contains(pairs[at].b);
}

}  // namespace

std::vector<bool> AreInLoops(const std::vector<PairOfSession>& pairs) {
  std::vector<bool> in_loop;
  for (std::size_t i = 0; i < pairs.size(); ++i) in_loop.push_back(pairs[i].is_whole && IsInLoop(i, pairs));
  return in_loop;
}

}  // namespace rigcal
