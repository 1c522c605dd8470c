#include "server/fleet/findings/effect.h"

#include <algorithm>
#include <map>

#include "server/fleet/wording.h"

namespace rigcal::fleet {
namespace {

// What the others say of an edge, as far as that was worked out.
std::optional<Vector6d> OffByOthers(const GraphSolution& solution, const EdgeId& edge) {
  const std::vector<EdgeInfluence>& all = solution.influences.edges;
  const auto found = std::lower_bound(all.begin(), all.end(), edge,
                                      [](const EdgeInfluence& one, const EdgeId& id) { return one.edge < id; });
  return found != all.end() && found->edge == edge && found->checked ? std::optional(found->off) : std::nullopt;
}

PoseLimits LimitsOfEdge(const Policy& policy, const Edge& edge) { return LimitsOf(policy, edge.frame_a, edge.frame_b); }

bool IsSmallLoop(const CycleResidual& loop, const Policy& policy) {
  return !IsBeyond(loop.e, LimitsOfLoop(policy, loop.sensors).moved_min);
}

// Half a sentence that goes on with a size, by how many times the limit that is.
struct Disagreement {
  std::string what;
  Vector6d off = Vector6d::Zero();
  PoseLimit limit;
  const Edge* edge = nullptr;  // null: it is of more than one
};

std::string PairDiffers(const SensorId& a, const SensorId& b) { return a.str() + " and " + b.str() + " differ by "; }
std::string LoopIsOpen(const CycleResidual& loop) { return "the loop of " + List(loop.sensors) + " is open by "; }

// Of each the largest; nothing that is said twice.
class Collected {
 public:
  void Add(Disagreement one) {
    const double times = TimesLimit(one.off, one.limit);
    const auto [at, is_new] = all_.try_emplace(one.what, one);
    if (!is_new && times > TimesLimit(at->second.off, at->second.limit)) at->second = std::move(one);
  }
  // The one that is the most times its limit; null: there is none.
  [[nodiscard]] const Disagreement* Largest() const {
    const Disagreement* largest = nullptr;
    for (const auto& [what, one] : all_)
      if (largest == nullptr || TimesLimit(one.off, one.limit) > TimesLimit(largest->off, largest->limit))
        largest = &one;
    return largest;
  }
  [[nodiscard]] const std::map<std::string, Disagreement>& all() const { return all_; }
  [[nodiscard]] std::string AndMore() const {
    if (all_.size() < 2) return "";
    return all_.size() == 2 ? " (and one other by less)"
                            : " (and " + std::to_string(all_.size() - 1) + " others by less)";
  }

 private:
  std::map<std::string, Disagreement> all_;
};

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
  for (const CycleResidual& loop : solution.cycles.worst)
    if (loop.fails() && IsSmallLoop(loop, policy))
      small.Add({LoopIsOpen(loop), loop.e, LimitsOfLoop(policy, loop.sensors).moved_min});
  AddSmallSuspects(solution, policy, small);
  return small;
}

Collected LargeEdges(const std::vector<Edge>& edges, const GraphSolution& solution, const Policy& policy) {
  Collected large;
  for (const TestedEdge& one : TestEdges(edges, solution, policy)) {
    const Vector6d off = OffByOthers(solution, one.edge->id).value_or(one.residual->e);
    const PoseLimit limit = LimitsOfEdge(policy, *one.edge).tolerance;
    if (IsBeyond(off, limit)) large.Add({PairDiffers(one.edge->frame_a, one.edge->frame_b), off, limit, one.edge});
  }
  return large;
}

// Its worst axis by its tolerance; without a limit that is reached, no more than chance is behind what it disagrees in.
struct WeakEdge {
  const Edge* edge = nullptr;
  double sigma_m = 0.0, sigma_rad = 0.0;
  PoseLimit limit;
  [[nodiscard]] double Times() const { return std::max(sigma_m / limit.m, sigma_rad / limit.rad); }
};

WeakEdge WeaknessOf(const Edge& edge, const Policy& policy) {
  WeakEdge weak{&edge, 0.0, 0.0, LimitsOfEdge(policy, edge).tolerance};
  for (int axis = 0; axis < 6; ++axis) {
    const AxisSigma sigma = SigmaOf(edge.uncertainty, axis);
    double& worst = axis < 3 ? weak.sigma_m : weak.sigma_rad;
    if (sigma.known) worst = std::max(worst, sigma.value);
  }
  return weak;
}

// By far the weakest of these, beyond its tolerance; nothing where none is.
std::optional<WeakEdge> WeakestOf(const std::vector<const Edge*>& edges, const Policy& policy) {
  constexpr double kFarTimes = 2.0;
  std::vector<WeakEdge> weak;
  for (const Edge* edge : edges) weak.push_back(WeaknessOf(*edge, policy));
  std::sort(weak.begin(), weak.end(), [](const WeakEdge& x, const WeakEdge& y) { return x.Times() > y.Times(); });
  if (weak.empty() || weak.front().Times() <= 1.0) return std::nullopt;
  if (weak.size() > 1 && weak.front().Times() < kFarTimes * weak[1].Times()) return std::nullopt;
  return weak.front();
}

// What disagrees by no more than chance does so because one of its measurements is so weak.
std::vector<const Edge*> EdgesIn(const Collected& large) {
  std::vector<const Edge*> edges;
  for (const auto& [what, one] : large.all())
    if (one.edge != nullptr) edges.push_back(one.edge);
  return edges;
}

Collected LargeLoops(const GraphSolution& solution, const Policy& policy) {
  Collected large;
  for (const CycleResidual& loop : solution.cycles.worst) {
    const PoseLimit limit = LimitsOfLoop(policy, loop.sensors).tolerance;
    if (loop.limit > 0.0 && IsBeyond(loop.e, limit)) large.Add({LoopIsOpen(loop), loop.e, limit});
  }
  return large;
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
  return std::all_of(edges.begin(), edges.end(), is_small) &&
         std::all_of(solution.cycles.worst.begin(), solution.cycles.worst.end(),
                     [&](const CycleResidual& loop) { return !loop.tested || IsSmallLoop(loop, policy); });
}

GraphSolution WithoutSmall(const GraphSolution& solution, const Policy& policy) {
  GraphSolution left = solution;
  std::erase_if(left.suspects.two_poses,
                [&](const TwoPoses& two) { return !IsBeyond(two.difference, LimitsOf(policy, two.sensor).moved_min); });
  std::erase_if(left.suspects.edges, [&](const SuspectEdge& suspect) {
    return !IsBeyond(suspect.e, LimitsOf(policy, suspect.frame_a, suspect.frame_b).moved_min);
  });
  left.cycles.failing -= static_cast<std::int64_t>(std::erase_if(
      left.cycles.worst, [&](const CycleResidual& loop) { return loop.fails() && IsSmallLoop(loop, policy); }));
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

std::optional<Finding> FindNotCheckedFor(const std::vector<const Edge*>& unchecked,
                                         const std::vector<const Edge*>& loops, const Policy& policy) {
  const auto weakest = WeakestOf(loops, policy);
  if (!weakest) return std::nullopt;
  std::vector<std::string> others;
  for (const Edge* edge : unchecked)
    if (edge != weakest->edge && std::find(others.begin(), others.end(), NameOfEdge(*edge)) == others.end())
      others.push_back(NameOfEdge(*edge));
  const SensorId &a = weakest->edge->frame_a, &b = weakest->edge->frame_b;
  DecidingFigure figure =
      SigmaFigure(NameOfEdge(*weakest->edge) + " known to", weakest->sigma_m, weakest->sigma_rad, weakest->limit);
  const std::string known = NameOfEdge(*weakest->edge) + " is known to " + figure.value + " only";
  return Finding{others.empty() ? known + ": too little to check it by"
                                : List(others) + (others.size() == 1 ? " is" : " are") + " not checked: " + known,
                 "Measure " + a.str() + " and " + b.str() + " again",
                 {a, b},
                 std::move(figure)};
}

std::optional<Finding> FindLargeDisagreements(const std::vector<Edge>& edges, const GraphSolution& solution,
                                              const Policy& policy) {
  Collected large = LargeEdges(edges, solution, policy);
  const std::vector<const Edge*> disagreeing = EdgesIn(large);
  if (auto weakest = FindNotCheckedFor(disagreeing, disagreeing, policy)) return weakest;
  if (large.Largest() == nullptr) large = LargeLoops(solution, policy);
  const Disagreement* largest = large.Largest();
  if (largest == nullptr) return std::nullopt;
  return Finding{
      largest->what + OffText(largest->off) + large.AndMore() + ", more than the tolerance of " +
          LimitText(largest->limit),
      "Capture these sensors again, nearer and from more places, until they agree",
      largest->edge == nullptr ? std::vector<SensorId>() : std::vector{largest->edge->frame_a, largest->edge->frame_b},
      OffFigure(largest->edge == nullptr ? "Loop open by" : NameOfEdge(*largest->edge) + " differ by", largest->off,
                largest->limit)};
}

}  // namespace rigcal::fleet
