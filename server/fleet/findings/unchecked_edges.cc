// Edges that nothing else in the graph would show to be wrong: at all, in some directions, or by their tolerance.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "server/fleet/findings/bridges.h"
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

using Half = Eigen::Matrix3d;
// Information about the first three of six, whatever the others are; what nothing is known of does not matter.
Half Alone(const Matrix6d& J, int first, int others) {
  const Eigen::CompleteOrthogonalDecomposition<Half> rest(J.block<3, 3>(others, others));
  const Half cross = J.block<3, 3>(first, others);
  const Half alone = J.block<3, 3>(first, first) - cross * rest.solve(cross.transpose());
  return 0.5 * (alone + alone.transpose());
}

// Of an edge's position or rotation, what the others would not show: the edge says it to its tolerance, they do not.
struct CheckGap {
  const Edge* edge = nullptr;
  bool is_position = true;
  double times = 0.0;  // the tolerance, that the others know it to, 1 sigma; infinite: they say nothing of it
};

// In units of the tolerance, the least known direction of those that the edge itself tells to one of them.
double TimesTolerance(const Half& by_edge, const Half& by_others) {
  constexpr double kKnownNothing = 1e-6;  // a thousand tolerances
  double least = 1.0;
  const Eigen::SelfAdjointEigenSolver<Half> known(by_others);
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d along = known.eigenvectors().col(k);
    if (along.dot(by_edge * along) >= 1.0) least = std::min(least, std::max(known.eigenvalues()(k), 0.0));
  }
  return least < kKnownNothing ? std::numeric_limits<double>::infinity() : 1.0 / std::sqrt(least);
}

std::vector<CheckGap> GapsOf(const Edge& edge, const Matrix6d& by_others, const PoseLimit& tolerance) {
  Vector6d unit;
  unit << Eigen::Vector3d::Constant(tolerance.m), Eigen::Vector3d::Constant(tolerance.rad);
  const Matrix6d own = unit.asDiagonal() * edge.uncertainty.Omega * unit.asDiagonal();
  const Matrix6d others = unit.asDiagonal() * by_others * unit.asDiagonal();
  std::vector<CheckGap> gaps;
  for (const int first : {0, 3}) {
    const double times = TimesTolerance(own.block<3, 3>(first, first), Alone(others, first, 3 - first));
    if (times > 1.0) gaps.push_back({&edge, first == 0, times});
  }
  return gaps;
}

std::vector<CheckGap> AllGaps(const std::vector<Edge>& edges, const GraphSolution& solution, const Policy& policy,
                              const OtherPaths& others) {
  const std::set<EdgeId> told = UncheckedEdges(solution), bridges = FindBridges(edges, solution).edges;
  std::vector<CheckGap> gaps;
  for (const Edge& edge : edges) {
    const auto known = others.find(edge.id);
    if (known == others.end() || edge.state != EdgeState::kGood || told.contains(edge.id) || bridges.contains(edge.id))
      continue;
    const std::vector<CheckGap> own = GapsOf(edge, known->second, LimitsOfEdge(policy, edge).tolerance);
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

// Of one half.
Finding NotCheckedIn(const std::vector<CheckGap>& gaps, const Policy& policy) {
  constexpr std::size_t kNamedMax = 3;  // of more a sentence tells how many: the same is done about each
  const std::vector<const Edge*> edges = EdgesOf(gaps);
  const std::vector<std::string> names = NamesOf(edges);
  const CheckGap& worst = *std::max_element(gaps.begin(), gaps.end(),
                                            [](const CheckGap& x, const CheckGap& y) { return x.times < y.times; });
  const PoseLimit tolerance = LimitsOfEdge(policy, *worst.edge).tolerance;
  std::string why = std::string("the ") + (worst.is_position ? "position" : "rotation") + " of " +
                    (names.size() > kNamedMax ? std::to_string(names.size()) + " pairs" : List(names)) +
                    " is not checked";
  DecidingFigure figure;
  if (std::isinf(worst.times)) {
    why += " by anything else";
  } else {
    figure = SigmaFigure("Check of " + NameOfEdge(*worst.edge) + " good to",
                         worst.is_position ? worst.times * tolerance.m : 0.0,
                         worst.is_position ? 0.0 : worst.times * tolerance.rad, tolerance);
    why += std::string(": the other measurements tell it") + (names.size() == 1 ? "" : ", at worst,") + " to " +
           figure.value + " only";
  }
  return {std::move(why), RepeatEach(names), SharedByAll(edges), std::move(figure)};
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
  for (const bool is_position : {true, false})
    for (const bool by_nothing : {true, false}) {
      std::vector<CheckGap> alike;
      std::copy_if(gaps.begin(), gaps.end(), std::back_inserter(alike), [&](const CheckGap& one) {
        return one.is_position == is_position && std::isinf(one.times) == by_nothing;
      });
      if (!alike.empty()) findings.push_back(NotCheckedIn(alike, policy));
    }
  return findings;
}

}  // namespace rigcal::fleet
