#include <algorithm>
#include <iterator>
#include <optional>
#include <span>
#include <tuple>

#include "server/graph/fusion/merged_edge.h"
#include "server/graph/fusion/scatter_of_most.h"
#include "server/graph/fusion/session_fusion.h"
#include "server/math/covariance.h"
#include "server/model/edges/past.h"

namespace rigcal::graph {
namespace {

// In time, by id where that is the same. `between`: how the edges of its pair scatter.
struct Timed {
  Stamp at;
  const Edge* edge = nullptr;
  Matrix6d between = Matrix6d::Zero();
};

bool Earlier(const Timed& x, const Timed& y) { return std::tie(x.at, x.edge->id) < std::tie(y.at, y.edge->id); }

// By the `kept` that were measured next: an edge that is wrong must not excuse itself, and these are there whether the
// pair is merged week by week or at once. Edges that leave a direction open tell nothing of it and are left out.
void FindScatter(std::vector<Timed>& all, std::size_t older, std::size_t kept) {
  std::vector<std::optional<MeasuredPlace>> places;
  for (const Timed& one : all) {
    const Uncertainty& known = one.edge->uncertainty;
    places.emplace_back();
    if (known.rank == 6) places.back() = {one.edge->T_a_b, Observable(known.Omega).covariance};
  }
  for (std::size_t i = 0; i < older; ++i) {
    std::vector<MeasuredPlace> next;
    for (std::size_t j = i + 1; j <= i + kept; ++j)
      if (places[j]) next.push_back(*places[j]);
    all[i].between = ScatterOfMost(next);
  }
}

// With at least half of `others`.
bool AgreesWithHalf(const Timed& one, std::span<const Timed> others) {
  std::size_t agreeing = 0;
  for (const Timed& other : others) agreeing += Agree(*one.edge, *other.edge, one.between) ? 1 : 0;
  return 2 * agreeing >= others.size();
}

// The older edges of one pair and method, the oldest first.
class PairMerge {
 public:
  PairMerge(std::vector<MergedEdge>& parts, std::vector<EdgeId>& taken) : parts_(parts), taken_(taken) {}

  // All but the newest `kept` of `all`, and but the newest `kept` of those that contradict every part.
  void Take(const std::vector<Timed>& all, std::size_t kept) {
    std::vector<Timed> apart(all.begin(), all.end() - static_cast<std::ptrdiff_t>(kept));
    if (parts_.empty()) BeginWithTrusted(all, kept, apart);
    TakeAgreeing(apart);
    while (apart.size() > kept) {
      if (BeginPart(kept, apart))
        TakeAgreeing(apart);
      else
        TakeThoughOff(apart);
    }
  }

 private:
  void TakeInto(const Timed& one, MergedEdge& part) {
    Add(*one.edge, one.at, part, one.between);
    taken_.push_back(one.edge->id);
  }

  void Begin(std::size_t first, std::vector<Timed>& apart) {
    MergedEdge& part = parts_.emplace_back();
    part.part = static_cast<int>(parts_.size()) - 1;
    TakeInto(apart[first], part);
    apart.erase(apart.begin() + static_cast<std::ptrdiff_t>(first));
  }

  // With the first that half of those agree with that were measured next, so that it is no wrong one.
  void BeginWithTrusted(const std::vector<Timed>& all, std::size_t kept, std::vector<Timed>& apart) {
    for (std::size_t i = 0; i < apart.size(); ++i)
      if (AgreesWithHalf(all[i], {&all[i] + 1, kept})) return Begin(i, apart);
  }

  void TakeAgreeing(std::vector<Timed>& apart) {
    std::vector<Timed> left;
    for (const Timed& one : apart) {
      const auto part = std::find_if(parts_.begin(), parts_.end(),
                                     [&](const MergedEdge& each) { return Agree(each, *one.edge, one.between); });
      if (part == parts_.end())
        left.push_back(one);
      else
        TakeInto(one, *part);
    }
    apart = std::move(left);
  }

  // Of the oldest the first that half of these agree with: what it is contradicted by was before a move, or is after
  // it.
  bool BeginPart(std::size_t kept, std::vector<Timed>& apart) {
    if (parts_.size() >= kMergedPartsMax) return false;
    const std::span<const Timed> oldest(apart.data(), kept + 1);
    for (std::size_t i = 0; i <= kept; ++i) {
      std::vector<Timed> others(oldest.begin(), oldest.end());
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
      if (!AgreesWithHalf(oldest[i], others)) continue;
      Begin(i, apart);
      return true;
    }
    if (!parts_.empty()) return false;
    Begin(0, apart);
    return true;
  }

  // The oldest, with an uncertainty that covers what it is off from the nearest part.
  void TakeThoughOff(std::vector<Timed>& apart) {
    const Timed one = apart.front();
    const auto off_in_sigmas = [&](const MergedEdge& part) {
      const Vector6d e = (part.T_a_b.Inverse() * one.edge->T_a_b).Log();
      return e.dot(one.edge->uncertainty.Omega * e);
    };
    MergedEdge& nearest = *std::min_element(
        parts_.begin(), parts_.end(),
        [&](const MergedEdge& x, const MergedEdge& y) { return off_in_sigmas(x) < off_in_sigmas(y); });
    Add(AsUnsureAsOff(*one.edge, nearest, one.between), one.at, nearest);
    taken_.push_back(one.edge->id);
    apart.erase(apart.begin());
  }

  std::vector<MergedEdge>& parts_;
  std::vector<EdgeId>& taken_;
};

// Past with its sensor, which was retired or remounted. One that was retired by itself is told for good.
bool IsPastWithSensor(const Edge& edge) { return IsPast(edge) && edge.diagnoses.front().code != kRetiredCode; }

// All but the newest `kept` of each pair and method. Nothing is made of them.
void TakeOlder(std::map<MeasuredPair, std::vector<Timed>> past, std::size_t kept, std::vector<EdgeId>& taken) {
  for (auto& [key, all] : past) {
    std::sort(all.begin(), all.end(), Earlier);
    for (std::size_t i = 0; i + kept < all.size(); ++i) taken.push_back(all[i].edge->id);
  }
}

}  // namespace

Merge MergeOlderEdges(const std::vector<MergedEdge>& before, const std::vector<Edge>& edges,
                      const std::map<EdgeId, Stamp>& measured_at, std::size_t kept) {
  std::map<MeasuredPair, std::vector<MergedEdge>> merged;
  for (const MergedEdge& one : before)
    if (!one.of_sessions) merged[{one.frame_a, one.frame_b, one.method}].push_back(one);
  std::map<MeasuredPair, std::vector<Timed>> of_pair, past;
  for (const Edge& edge : edges) {
    const auto at = measured_at.find(edge.id);
    if (!edge.session.empty() || IsMerged(edge) || at == measured_at.end()) continue;
    if (edge.state == EdgeState::kGood) of_pair[PairOf(edge)].push_back({at->second, &edge});
    if (IsPastWithSensor(edge)) past[PairOf(edge)].push_back({at->second, &edge});
  }
  Merge result;
  TakeOlder(std::move(past), kept, result.taken);
  for (auto& [key, all] : of_pair) {
    if (all.size() <= kept) continue;
    std::sort(all.begin(), all.end(), Earlier);
    FindScatter(all, all.size() - kept, kept);
    PairMerge(merged[key], result.taken).Take(all, kept);
  }
  for (auto& [key, parts] : merged) std::move(parts.begin(), parts.end(), std::back_inserter(result.merged));
  return result;
}

}  // namespace rigcal::graph
