#include "server/graph/merge_edges.h"

#include <algorithm>
#include <tuple>

#include "server/graph/merged_edge.h"

namespace rigcal::graph {
namespace {

// In time, by id where that is the same.
using Timed = std::pair<Stamp, const Edge*>;

// Where merging begins: the first of `older` that at least half of the others agree with, so that it is no wrong one.
std::size_t FirstOf(const std::vector<Timed>& all, std::size_t older) {
  for (std::size_t i = 0; i < older; ++i) {
    std::size_t agreeing = 0;
    for (const Timed& other : all) agreeing += Agree(*all[i].second, *other.second) ? 1 : 0;
    if (2 * agreeing >= all.size() + 1) return i;
  }
  return older;
}

void MergeOldest(const std::vector<Timed>& all, std::size_t older, MergedEdge& merged, std::vector<EdgeId>& taken) {
  const auto take = [&](const Timed& one) {
    Add(*one.second, one.first, merged);
    taken.push_back(one.second->id);
  };
  std::size_t first = all.size();
  if (merged.count == 0) {
    first = FirstOf(all, older);
    if (first == older) return;
    take(all[first]);
  }
  for (std::size_t i = 0; i < older; ++i)
    if (i != first && Agree(merged, *all[i].second)) take(all[i]);
}

}  // namespace

Merge MergeOlderEdges(const std::vector<MergedEdge>& before, const std::vector<Edge>& edges,
                      const std::map<EdgeId, Stamp>& measured_at, std::size_t kept) {
  std::map<MeasuredPair, MergedEdge> merged;
  for (const MergedEdge& one : before)
    if (!one.of_sessions) merged.emplace(MeasuredPair{one.frame_a, one.frame_b, one.method}, one);
  std::map<MeasuredPair, std::vector<Timed>> of_pair;
  for (const Edge& edge : edges)
    if (const auto at = measured_at.find(edge.id); edge.state == EdgeState::kGood && edge.session.empty() &&
                                                   !IsMerged(edge) && at != measured_at.end())
      of_pair[PairOf(edge)].emplace_back(at->second, &edge);
  Merge result;
  for (auto& [key, all] : of_pair) {
    std::sort(all.begin(), all.end(), [](const auto& x, const auto& y) {
      return std::tie(x.first, x.second->id) < std::tie(y.first, y.second->id);
    });
    if (all.size() > kept) MergeOldest(all, all.size() - kept, merged[key], result.taken);
  }
  for (auto& [key, one] : merged)
    if (one.count > 0) result.merged.push_back(std::move(one));
  return result;
}

}  // namespace rigcal::graph
