// Edges that nothing else in the graph would show to be wrong: at all, in some directions, or by their tolerance.
#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "server/fleet/findings/bridges.h"
#include "server/fleet/findings/check_gaps.h"
#include "server/fleet/findings/disagreements.h"
#include "server/fleet/findings/effect.h"
#include "server/fleet/wording.h"
#include "server/model/graph/unchecked.h"

namespace rigcal::fleet {
namespace {

bool IsIn(const CycleResidual& loop, const EdgeId& edge) {
  return std::find(loop.edges.begin(), loop.edges.end(), edge) != loop.edges.end();
}

// Of the loops that were worked out those that one of `of` is in.
std::vector<const Edge*> EdgesOfLoopsWith(const std::vector<const Edge*>& of, const std::vector<Edge>& edges,
                                          const Cycles& cycles) {
  std::set<EdgeId> ids;
  for (const CycleResidual* loop : cycles.Loops())
    if (std::any_of(of.begin(), of.end(), [&](const Edge* edge) { return IsIn(*loop, edge->id); }))
      ids.insert(loop->edges.begin(), loop->edges.end());
  std::vector<const Edge*> inside;
  for (const Edge& edge : edges)
    if (ids.contains(edge.id)) inside.push_back(&edge);
  return inside;
}

// One of the edges that is by far the weakest, and that every one of them is in a loop with.
std::optional<WeakEdge> WeakestBehind(const std::vector<const Edge*>& unchecked, const std::vector<Edge>& edges,
                                      const Cycles& cycles, const Policy& policy) {
  const auto weakest = WeakestOf(EdgesOfLoopsWith(unchecked, edges, cycles), policy);
  if (!weakest) return std::nullopt;
  const std::vector<const Edge*> beside = EdgesOfLoopsWith({weakest->edge}, edges, cycles);
  const bool behind_all = std::all_of(unchecked.begin(), unchecked.end(), [&](const Edge* edge) {
    return std::find(beside.begin(), beside.end(), edge) != beside.end();
  });
  return behind_all ? weakest : std::nullopt;
}

std::vector<std::string> NamesOf(const std::vector<const Edge*>& edges) {
  std::vector<std::string> names;
  for (const Edge* edge : edges)
    if (std::find(names.begin(), names.end(), NameOfEdge(*edge)) == names.end()) names.push_back(NameOfEdge(*edge));
  return names;
}

std::vector<SensorId> SharedByAll(const std::vector<const Edge*>& edges) {
  std::vector<std::pair<SensorId, SensorId>> pairs;
  for (const Edge* edge : edges) pairs.emplace_back(edge->frame_a, edge->frame_b);
  return SharedBy(pairs);
}

std::string RepeatEach(const std::vector<std::string>& names) {
  return "Repeat " + List(names) + " in a session of " + (names.size() == 1 ? "its" : "their") +
         " own, with motion or boards in every direction";
}

std::vector<CheckGap> AllGaps(const std::vector<Edge>& edges, const GraphSolution& solution, const Policy& policy,
                              const OtherPaths& others) {
  const std::set<EdgeId> told = UncheckedEdges(solution), bridges = FindBridges(edges, solution).edges;
  std::vector<CheckGap> gaps;
  for (const Edge& edge : edges) {
    const auto known = others.find(edge.id);
    if (known == others.end() || edge.state != EdgeState::kGood || told.contains(edge.id) || bridges.contains(edge.id))
      continue;
    const std::vector<CheckGap> own = GapsOf(edge, known->second, solution, policy);
    gaps.insert(gaps.end(), own.begin(), own.end());
  }
  return gaps;
}

std::vector<const Edge*> EdgesOf(const std::vector<CheckGap>& gaps) {
  std::vector<const Edge*> edges;
  for (const CheckGap& one : gaps)
    if (std::find(edges.begin(), edges.end(), one.edge) == edges.end()) edges.push_back(one.edge);
  return edges;
}

DecidingFigure FigureOf(const CheckGap& gap, const Policy& policy) {
  if (gap.by_nothing()) return {};
  const PoseLimit tolerance = LimitsOfEdge(policy, *gap.edge).tolerance;
  return SigmaFigure("Check of " + NameOfEdge(*gap.edge) + " good to",
                     gap.is_position ? gap.times_tolerance * tolerance.m : 0.0,
                     gap.is_position ? 0.0 : gap.times_tolerance * tolerance.rad, tolerance);
}

// "is not checked by anything else", "are not checked: the other measurements tell them, at worst, to 200 mm only
// (limit 5 mm)".
std::string NotCheckedText(const CheckGap& gap, const Policy& policy, bool of_one_pair) {
  const std::string text = std::string(gap.several ? "are" : "is") + " not checked";
  if (gap.by_nothing()) return text + " by anything else";
  const DecidingFigure figure = FigureOf(gap, policy);
  return text + ": the other measurements tell " + (gap.several ? "them" : "it") + (of_one_pair ? "" : ", at worst,") +
         " to " + figure.value + " only (" + figure.limit + ")";
}

// What is the same of all of them.
Finding NotCheckedIn(const std::vector<CheckGap>& gaps, const Policy& policy) {
  constexpr std::size_t kNamedMax = 3;  // of more a sentence tells how many: the same is done about each
  const std::vector<const Edge*> edges = EdgesOf(gaps);
  const std::vector<std::string> names = NamesOf(edges);
  const CheckGap& worst = *std::max_element(gaps.begin(), gaps.end(), [](const CheckGap& x, const CheckGap& y) {
    return x.times_tolerance < y.times_tolerance;
  });
  const std::string of = "of " + (names.size() > kNamedMax ? std::to_string(names.size()) + " pairs" : List(names));
  std::string why = (worst.names_sensor ? of + " " + worst.what : worst.what + " " + of) + " " +
                    NotCheckedText(worst, policy, names.size() == 1);
  return {std::move(why), RepeatEach(names), SharedByAll(edges), FigureOf(worst, policy)};
}

// Positions first, of each what nothing checks first.
std::vector<std::vector<CheckGap>> GroupsAlike(const std::vector<CheckGap>& gaps) {
  std::map<std::tuple<bool, bool, std::string>, std::vector<CheckGap>> alike;
  for (const CheckGap& gap : gaps) alike[{!gap.is_position, !gap.by_nothing(), gap.what}].push_back(gap);
  std::vector<std::vector<CheckGap>> groups;
  for (auto& [key, group] : alike) groups.push_back(std::move(group));
  return groups;
}

}  // namespace

std::optional<Finding> FindUncheckedEdges(const std::vector<Edge>& edges, const GraphSolution& solution,
                                          const Policy& policy) {
  if (solution.dof <= 0) return std::nullopt;
  const std::set<EdgeId> ids = UncheckedEdges(solution), bridges = FindBridges(edges, solution).edges;
  std::vector<const Edge*> unchecked;
  for (const Edge& edge : edges)
    if (ids.contains(edge.id) && !bridges.contains(edge.id)) unchecked.push_back(&edge);
  if (unchecked.empty()) return std::nullopt;
  if (const auto weak = WeakestBehind(unchecked, edges, solution.cycles, policy))
    return NotCheckedFor(unchecked, *weak);
  const std::vector<std::string> names = NamesOf(unchecked);
  const bool one = names.size() == 1;
  return Finding{"nothing checks " + List(names) + ": the other edges of " + (one ? "its" : "their") +
                     " loops fit whatever " + (one ? "it says" : "they say"),
                 RepeatEach(names), SharedByAll(unchecked)};
}

std::vector<Finding> FindHardlyChecked(const std::vector<Edge>& edges, const GraphSolution& solution,
                                       const Policy& policy, const OtherPaths& others) {
  if (solution.dof <= 0) return {};
  const std::vector<CheckGap> gaps = AllGaps(edges, solution, policy, others);
  if (gaps.empty()) return {};
  if (const auto weak = WeakestBehind(EdgesOf(gaps), edges, solution.cycles, policy))
    return {NotCheckedFor(EdgesOf(gaps), *weak)};
  std::vector<Finding> findings;
  for (const std::vector<CheckGap>& alike : GroupsAlike(gaps)) findings.push_back(NotCheckedIn(alike, policy));
  return findings;
}

std::vector<HardlyChecked> EdgesHardlyChecked(const std::vector<Edge>& edges, const GraphSolution& solution,
                                              const Policy& policy, const OtherPaths& others) {
  if (solution.dof <= 0) return {};
  std::vector<HardlyChecked> hardly;
  for (const CheckGap& gap : AllGaps(edges, solution, policy, others)) {
    const std::string what = gap.what + " " + NotCheckedText(gap, policy, true);
    if (hardly.empty() || hardly.back().edge != gap.edge->id)
      hardly.push_back({gap.edge->id, what});
    else
      hardly.back().what += "; " + what;
  }
  return hardly;
}

}  // namespace rigcal::fleet
