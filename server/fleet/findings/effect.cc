#include "server/fleet/findings/effect.h"

#include <algorithm>
#include <map>

#include "server/fleet/findings/disagreements.h"
#include "server/fleet/wording.h"

namespace rigcal::fleet {
namespace {

bool IsSmallLoop(const CycleResidual& loop, const Policy& policy) {
  return !IsBeyond(loop.e, LimitsOfLoop(policy, loop.sensors).moved_min);
}

// Of each edge of the solution that has a test: how many times its limit its statistic is.
struct TestedEdge {
  const Edge* edge = nullptr;
  const EdgeResidual* residual = nullptr;
  double ratio = 0.0;
};
std::vector<TestedEdge> TestEdges(const std::vector<Edge>& edges, const GraphSolution& solution, const Policy& policy) {
  std::map<EdgeId, const Edge*> by_id;
  for (const Edge& edge : edges) by_id.emplace(edge.id, &edge);
  const auto count = static_cast<std::size_t>(std::count_if(solution.residuals.begin(), solution.residuals.end(),
                                                            [](const EdgeResidual& one) { return one.in_solution; }));
  std::vector<TestedEdge> tested;
  for (const EdgeResidual& residual : solution.residuals) {
    const auto edge = by_id.find(residual.edge);
    if (edge == by_id.end() || !residual.in_solution) continue;
    const EdgeTest test = TestResidual(*edge->second, residual, count, policy);
    if (test.limit > 0.0) tested.push_back({edge->second, &residual, test.statistic / test.limit});
  }
  return tested;
}

bool SharesCaptures(const GraphSolution& solution) {
  return std::any_of(solution.residuals.begin(), solution.residuals.end(),
                     [](const EdgeResidual& residual) { return residual.by_jackknife; });
}

// Found with edges taken as independent: over shared captures they say nothing by themselves.
void AddSmallSuspects(const GraphSolution& solution, const Policy& policy, Collected& small) {
  if (SharesCaptures(solution)) return;
  for (const TwoPoses& two : solution.suspects.two_poses)
    if (const PoseLimit limit = LimitsOf(policy, two.sensor).moved_min; !IsBeyond(two.difference, limit))
      small.Add({"two poses of " + two.sensor.str() + " differ by ", two.difference, limit});
  for (const SuspectEdge& suspect : solution.suspects.edges)
    if (const PoseLimit limit = LimitsOf(policy, suspect.frame_a, suspect.frame_b).moved_min;
        !IsBeyond(suspect.e, limit))
      small.Add({PairDiffers(suspect.frame_a, suspect.frame_b), suspect.e, limit});
}

Collected SmallOf(const std::vector<Edge>& edges, const GraphSolution& solution, const Policy& policy) {
  Collected small;
  for (const TestedEdge& one : TestEdges(edges, solution, policy))
    if (one.ratio > 1.0 && IsSmall(*one.edge, solution, policy))
      small.Add({PairDiffers(one.edge->frame_a, one.edge->frame_b), *OffByOthers(solution, one.edge->id),
                 LimitsOfEdge(policy, *one.edge).moved_min});
  for (const CycleResidual* loop : solution.cycles.Loops())
    if (loop->fails() && IsSmallLoop(*loop, policy))
      small.Add({LoopIsOpen(*loop), loop->e, LimitsOfLoop(policy, loop->sensors).moved_min});
  AddSmallSuspects(solution, policy, small);
  return small;
}

}  // namespace

bool IsSmall(const Edge& edge, const GraphSolution& solution, const Policy& policy) {
  const auto off = OffByOthers(solution, edge.id);
  return off && !IsBeyond(*off, LimitsOfEdge(policy, edge).moved_min);
}

bool AllIsSmall(const std::vector<Edge>& edges, const GraphSolution& solution, const Policy& policy) {
  if (!solution.influences.judged) return false;
  const auto is_small = [&](const Edge& edge) {
    const auto off = OffByOthers(solution, edge.id);
    return !off || !IsBeyond(*off, LimitsOfEdge(policy, edge).moved_min);
  };
  const std::vector<const CycleResidual*> loops = solution.cycles.Loops();
  return std::all_of(edges.begin(), edges.end(), is_small) &&
         std::all_of(loops.begin(), loops.end(),
                     [&](const CycleResidual* loop) { return !loop->tested || IsSmallLoop(*loop, policy); });
}

GraphSolution WithoutSmall(const GraphSolution& solution, const Policy& policy) {
  GraphSolution left = solution;
  std::erase_if(left.suspects.two_poses,
                [&](const TwoPoses& two) { return !IsBeyond(two.difference, LimitsOf(policy, two.sensor).moved_min); });
  std::erase_if(left.suspects.edges, [&](const SuspectEdge& suspect) {
    return !IsBeyond(suspect.e, LimitsOf(policy, suspect.frame_a, suspect.frame_b).moved_min);
  });
  for (auto* loops : {&left.cycles.worst, &left.cycles.others})
    left.cycles.failing -= static_cast<std::int64_t>(
        std::erase_if(*loops, [&](const CycleResidual& loop) { return loop.fails() && IsSmallLoop(loop, policy); }));
  return left;
}

std::string SmallDisagreements(const std::vector<Edge>& edges, const GraphSolution& solution, const Policy& policy) {
  const Collected small = SmallOf(edges, solution, policy);
  if (const Disagreement* largest = small.Largest(); largest != nullptr)
    return largest->what + OffText(largest->off) + small.AndMore() + ", more than chance but within " +
           LimitText(largest->limit);
  if (!IsCostBeyondChance(edges, solution, policy) || !AllIsSmall(edges, solution, policy)) return "";
  return "the loops of edges are open by more than chance, but none by more than " +
         LimitText(LimitsOfLoop(policy, {}).moved_min);
}

}  // namespace rigcal::fleet
