// What is off by more than the policy's tolerance, and what is off only as one of its measurements is so weak.
#include <algorithm>
#include <map>
#include <set>

#include "server/fleet/findings/bridges.h"
#include "server/fleet/findings/disagreements.h"
#include "server/fleet/findings/effect.h"
#include "server/fleet/wording.h"

namespace rigcal::fleet {
namespace {

struct LargeDisagreements {
  std::vector<Disagreement> edges;          // each of one edge
  std::vector<const CycleResidual*> loops;  // all of them, whether or not they explain an edge
};

// Whatever chance allows: an edge of few captures too. What its session's own errors leave unchecked is off by nothing.
std::vector<Disagreement> LargeEdges(const std::vector<Edge>& edges, const GraphSolution& solution,
                                     const Policy& policy) {
  std::map<EdgeId, const Edge*> by_id;
  for (const Edge& edge : edges) by_id.emplace(edge.id, &edge);
  std::vector<Disagreement> large;
  for (const EdgeResidual& residual : solution.residuals) {
    const auto found = by_id.find(residual.edge);
    if (found == by_id.end() || !residual.in_solution || (residual.by_jackknife && residual.rank < 1)) continue;
    const Edge& edge = *found->second;
    const Vector6d off = OffByOthers(solution, edge.id).value_or(residual.e);
    const PoseLimit limit = LimitsOfEdge(policy, edge).tolerance;
    if (edge.state == EdgeState::kGood && IsBeyond(off, limit))
      large.push_back({PairDiffers(edge.frame_a, edge.frame_b), off, limit, {edge.frame_a, edge.frame_b}, &edge});
  }
  return large;
}

LargeDisagreements LargeOnesOf(const std::vector<Edge>& edges, const GraphSolution& solution, const Policy& policy) {
  LargeDisagreements large{LargeEdges(edges, solution, policy), {}};
  for (const CycleResidual* loop : solution.cycles.Loops())
    if (loop->tested && IsBeyond(loop->e, LimitsOfLoop(policy, loop->sensors).tolerance)) large.loops.push_back(loop);
  return large;
}

bool HasEdgeOf(const CycleResidual& loop, const std::set<EdgeId>& ids) {
  return std::any_of(loop.edges.begin(), loop.edges.end(), [&](const EdgeId& id) { return ids.contains(id); });
}

WeakEdge WeaknessOf(const Edge& edge, const Policy& policy) {
  WeakEdge weak{&edge, 0.0, 0.0, LimitsOfEdge(policy, edge).tolerance};
  for (int axis = 0; axis < 6; ++axis) {
    const AxisSigma sigma = SigmaOf(edge.uncertainty, axis);
    double& worst = axis < 3 ? weak.sigma_m : weak.sigma_rad;
    if (sigma.known) worst = std::max(worst, sigma.value);
  }
  return weak;
}

// Those that are weak, by far the weakest of these, and alike among themselves, the weakest first: beyond their
// tolerance, and beyond all others. None: there are no such edges.
std::vector<WeakEdge> WeakestAlike(const std::vector<const Edge*>& edges, const Policy& policy) {
  constexpr double kFarTimes = 2.0;
  std::vector<WeakEdge> weak;
  for (const Edge* edge : edges) weak.push_back(WeaknessOf(*edge, policy));
  std::stable_sort(weak.begin(), weak.end(),
                   [](const WeakEdge& x, const WeakEdge& y) { return x.Times() > y.Times(); });
  std::size_t count = 0;
  while (count < weak.size() && weak[count].Times() > 1.0) {
    ++count;
    if (count == weak.size() || weak[count - 1].Times() >= kFarTimes * weak[count].Times())
      return {weak.begin(), weak.begin() + static_cast<std::ptrdiff_t>(count)};
  }
  return {};
}

std::vector<const Edge*> EdgesIn(const std::vector<Disagreement>& large) {
  std::vector<const Edge*> edges;
  for (const Disagreement& one : large) edges.push_back(one.edge);
  return edges;
}

// Edges that no loop is left to check without these.
std::set<EdgeId> BridgesWithout(const std::set<EdgeId>& ids, std::vector<Edge> edges, const GraphSolution& solution) {
  std::erase_if(edges, [&](const Edge& edge) { return ids.contains(edge.id); });
  return FindBridges(edges, solution).edges;
}

// Takes the weak ones out of `large`, with what disagrees for them alone: an edge stays where a loop without them is
// open as well. Where not all loops were worked out, and of an edge that leaves directions open, as no loop over it
// tells of these, any loop without them will do.
std::vector<Disagreement> TakeWeak(const std::vector<WeakEdge>& weak, const std::vector<Edge>& edges,
                                   const GraphSolution& solution, LargeDisagreements& large) {
  std::set<EdgeId> ids, open;
  for (const WeakEdge& one : weak) ids.insert(one.edge->id);
  std::erase_if(large.loops, [&](const CycleResidual* loop) { return HasEdgeOf(*loop, ids); });
  for (const CycleResidual* loop : large.loops) open.insert(loop->edges.begin(), loop->edges.end());
  const bool all_known = solution.cycles.judged && solution.cycles.why_not.empty();
  const std::set<EdgeId> bridges = BridgesWithout(ids, edges, solution);
  const auto taken = std::stable_partition(large.edges.begin(), large.edges.end(), [&](const Disagreement& one) {
    const EdgeId& id = one.edge->id;
    const bool no_loop_tells = !all_known || one.edge->uncertainty.rank < 6;
    return !ids.contains(id) && (open.contains(id) || (no_loop_tells && !bridges.contains(id)));
  });
  std::vector<Disagreement> hanging(taken, large.edges.end());
  large.edges.erase(taken, large.edges.end());
  return hanging;
}

std::optional<Finding> FindingOfLarge(const Collected& large) {
  const Disagreement* largest = large.Largest();
  if (largest == nullptr) return std::nullopt;
  const std::string name = largest->edge == nullptr ? "Loop open by" : NameOfEdge(*largest->edge) + " differ by";
  return Finding{largest->what + OffText(largest->off) + large.AndMore() + ", more than the tolerance of " +
                     LimitText(largest->limit),
                 "Capture " + List(large.Sensors()) + " again, nearer and from more places, until they agree",
                 largest->edge == nullptr ? std::vector<SensorId>() : largest->sensors,
                 OffFigure(name, largest->off, largest->limit)};
}

// Edges, and loops that none of them explains.
std::optional<Finding> FindingOfLarge(const LargeDisagreements& large, const Policy& policy) {
  Collected collected;
  std::set<EdgeId> told;
  for (const Disagreement& one : large.edges) {
    told.insert(one.edge->id);
    collected.Add(one);
  }
  for (const CycleResidual* loop : large.loops)
    if (!HasEdgeOf(*loop, told))
      collected.Add({LoopIsOpen(*loop), loop->e, LimitsOfLoop(policy, loop->sensors).tolerance, loop->sensors});
  return FindingOfLarge(collected);
}

// One weak edge is to blame by itself; several that are alike disagree as all others do.
std::optional<Finding> FindingOfWeak(const std::vector<WeakEdge>& weak, const std::vector<Disagreement>& hanging,
                                     const Policy& policy) {
  if (weak.size() == 1) return NotCheckedFor(EdgesIn(hanging), weak.front());
  return FindingOfLarge(LargeDisagreements{hanging, {}}, policy);
}

}  // namespace

double WeakEdge::Times() const { return std::max(sigma_m / limit.m, sigma_rad / limit.rad); }

std::optional<WeakEdge> WeakestOf(const std::vector<const Edge*>& edges, const Policy& policy) {
  const std::vector<WeakEdge> weak = WeakestAlike(edges, policy);
  return weak.size() == 1 ? std::optional(weak.front()) : std::nullopt;
}

Finding NotCheckedFor(const std::vector<const Edge*>& unchecked, const WeakEdge& weakest) {
  std::vector<std::string> others;
  for (const Edge* edge : unchecked)
    if (edge != weakest.edge && std::find(others.begin(), others.end(), NameOfEdge(*edge)) == others.end())
      others.push_back(NameOfEdge(*edge));
  const SensorId &a = weakest.edge->frame_a, &b = weakest.edge->frame_b;
  DecidingFigure figure =
      SigmaFigure(NameOfEdge(*weakest.edge) + " known to", weakest.sigma_m, weakest.sigma_rad, weakest.limit);
  const std::string known = NameOfEdge(*weakest.edge) + " is known to " + figure.value + " only";
  return {others.empty() ? known + ": too little to check it by"
                         : List(others) + (others.size() == 1 ? " is" : " are") + " not checked: " + known,
          "Measure " + a.str() + " and " + b.str() + " again",
          {a, b},
          std::move(figure)};
}

std::vector<Finding> FindLargeDisagreements(const std::vector<Edge>& edges, const GraphSolution& solution,
                                            const Policy& policy) {
  LargeDisagreements large = LargeOnesOf(edges, solution, policy);
  std::vector<Finding> findings;
  while (true) {
    const std::vector<WeakEdge> weak = WeakestAlike(EdgesIn(large.edges), policy);
    if (weak.empty()) break;
    const std::vector<Disagreement> hanging = TakeWeak(weak, edges, solution, large);
    if (auto finding = FindingOfWeak(weak, hanging, policy)) findings.push_back(std::move(*finding));
  }
  // What sure measurements disagree in says more than that others are weak.
  if (auto sure = FindingOfLarge(large, policy)) findings.insert(findings.begin(), std::move(*sure));
  return findings;
}

}  // namespace rigcal::fleet
