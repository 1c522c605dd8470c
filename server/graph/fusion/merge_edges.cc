#include <algorithm>
#include <tuple>

#include "server/graph/fusion/merged_edge.h"
#include "server/model/edges/past.h"

namespace rigcal::graph {
namespace {

// In time, by id where that is the same.
using Timed = std::pair<Stamp, const Edge*>;

bool Earlier(const Timed& x, const Timed& y) {
  return std::tie(x.first, x.second->id) < std::tie(y.first, y.second->id);
}

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

// Past with its sensor, which was retired or remounted. One that was retired by itself is told for good.
bool IsPastWithSensor(const Edge& edge) { return IsPast(edge) && edge.diagnoses.front().code != kRetiredCode; }

// All but the newest `kept` of each pair and method. Nothing is made of them.
void TakeOlder(std::map<MeasuredPair, std::vector<Timed>> past, std::size_t kept, std::vector<EdgeId>& taken) {
  for (auto& [key, all] : past) {
    std::sort(all.begin(), all.end(), Earlier);
    for (std::size_t i = 0; i + kept < all.size(); ++i) taken.push_back(all[i].second->id);
  }
}

}  // namespace

Merge MergeOlderEdges(const std::vector<MergedEdge>& before, const std::vector<Edge>& edges,
                      const std::map<EdgeId, Stamp>& measured_at, std::size_t kept) {
  MergedPairs merged;
  for (const MergedEdge& one : before)
    if (!one.of_sessions) merged.emplace(MeasuredPair{one.frame_a, one.frame_b, one.method}, one);
  std::map<MeasuredPair, std::vector<Timed>> of_pair, past;
  for (const Edge& edge : edges) {
    const auto at = measured_at.find(edge.id);
    if (!edge.session.empty() || IsMerged(edge) || at == measured_at.end()) continue;
    if (edge.state == EdgeState::kGood) of_pair[PairOf(edge)].emplace_back(at->second, &edge);
    if (IsPastWithSensor(edge)) past[PairOf(edge)].emplace_back(at->second, &edge);
  }
  Merge result;
  TakeOlder(std::move(past), kept, result.taken);
  for (auto& [key, all] : of_pair) {
    std::sort(all.begin(), all.end(), Earlier);
    if (all.size() > kept) MergeOldest(all, all.size() - kept, merged[key], result.taken);
  }
  for (auto& [key, one] : merged)
    if (one.count > 0) result.merged.push_back(std::move(one));
  return result;
}

}  // namespace rigcal::graph
