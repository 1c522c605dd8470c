#include <Eigen/Cholesky>
#include <algorithm>
#include <set>

#include "server/graph/insight/edge_checks.h"
#include "server/graph/insight/insight.h"
#include "server/graph/solve/start_poses.h"
#include "server/math/covariance.h"

namespace rigcal::graph {
namespace {

constexpr std::size_t kAlternativesOfMax = 20;  // suspects for which alternatives are looked for

struct Split {
  const Graph& graph;
  const Problem& problem;
  const RobustOptimum& robust;

  [[nodiscard]] const GraphEdge& EdgeOf(std::size_t k) const {
    return graph.edges[problem.edges_by_id[problem.constraints[k].edge]];
  }
  [[nodiscard]] bool Touches(std::size_t k, int vertex) const {
    return problem.constraints[k].i == vertex || problem.constraints[k].j == vertex;
  }
  [[nodiscard]] int Other(std::size_t k, int vertex) const {
    const Constraint& c = problem.constraints[k];
    return c.i == vertex ? c.j : c.i;
  }
};

// Where an edge wants its sensor: Log(T_ref_sensor^-1 T_implied), with covariance.
struct Implied {
  Vector6d delta = Vector6d::Zero();
  Matrix6d C = Matrix6d::Zero();
};

Implied ImpliedAt(const Split& split, std::size_t k, int vertex) {
  const Constraint& c = split.problem.constraints[k];
  const EdgeCheck& check = split.robust.checks.edges[k];
  const Matrix6d C = Observable(c.Omega).covariance + check.C_prediction;
  if (c.j == vertex) return {-check.jacobian.e, C};
  const Matrix6d A = Adjoint(c.T_i_j);
  return {A * check.jacobian.e, Symmetrized(A * C * A.transpose())};
}

bool Agree(const Implied& a, const Implied& b, double limit) {
  const Vector6d difference = a.delta - b.delta;
  return difference.dot((a.C + b.C).ldlt().solve(difference)) <= limit;
}

// A sensor's rejected edges that imply one pose, beside those that are kept.
struct Candidate {
  int vertex = 0;
  std::vector<std::size_t> kept, rejected;
  Vector6d delta = Vector6d::Zero();
};

// The largest group of rejected edges that agree with one of them; earlier ones win ties.
void FindGroup(const Split& split, const std::vector<std::size_t>& rejected, Candidate& candidate) {
  for (const std::size_t k : rejected) {
    const Implied centre = ImpliedAt(split, k, candidate.vertex);
    std::vector<std::size_t> group;
    for (const std::size_t other : rejected)
      if (other == k || Agree(centre, ImpliedAt(split, other, candidate.vertex),
                              std::max(split.robust.limit[k], split.robust.limit[other])))
        group.push_back(other);
    if (group.size() <= candidate.rejected.size()) continue;
    candidate.rejected = group;
    candidate.delta = centre.delta;
  }
}

Candidate CandidateAt(const Split& split, int vertex, const std::vector<bool>& spoken_for) {
  Candidate candidate;
  candidate.vertex = vertex;
  std::vector<std::size_t> rejected;
  for (std::size_t k = 0; k < split.robust.kept.size(); ++k) {
    if (!split.Touches(k, vertex)) continue;
    if (split.robust.kept[k]) {
      candidate.kept.push_back(k);
    } else if (!spoken_for[k] && split.problem.constraints[k].rank == 6) {
      rejected.push_back(k);
    }
  }
  FindGroup(split, rejected, candidate);
  return candidate;
}

std::size_t NeighbourCount(const Split& split, const Candidate& candidate) {
  std::set<int> neighbours;
  for (const std::size_t k : candidate.rejected) neighbours.insert(split.Other(k, candidate.vertex));
  return neighbours.size();
}

// A lone edge against a lone edge: one of two, unless the other end could say the same of itself (a loop).
bool IsHalf(const Split& split, const Candidate& candidate) {
  if (candidate.kept.empty() || candidate.rejected.size() < candidate.kept.size()) return false;
  if (candidate.rejected.size() > 1) return true;
  int degree = 0;
  const int other = split.Other(candidate.rejected[0], candidate.vertex);
  for (std::size_t k = 0; k < split.robust.kept.size(); ++k) degree += split.Touches(k, other) ? 1 : 0;
  return degree > 2;
}

bool HasTwoPoses(const Split& split, const Candidate& candidate) {
  if (candidate.rejected.empty() || candidate.kept.empty()) return false;
  return (candidate.rejected.size() > 1 && NeighbourCount(split, candidate) > 1) || IsHalf(split, candidate);
}

std::vector<EdgeId> IdsOf(const Split& split, const std::vector<std::size_t>& edges) {
  std::vector<EdgeId> ids;
  for (const std::size_t k : edges) ids.push_back(split.EdgeOf(k).id);
  std::sort(ids.begin(), ids.end());
  return ids;
}

TwoPoses Describe(const Split& split, const Candidate& candidate) {
  TwoPoses two;
  two.sensor = split.graph.sensors[split.problem.sensor_of_vertex[static_cast<std::size_t>(candidate.vertex)]];
  two.group_a = IdsOf(split, candidate.kept);
  two.group_b = IdsOf(split, candidate.rejected);
  two.difference = candidate.delta;
  const bool swap = two.group_b.size() > two.group_a.size() ||
                    (two.group_b.size() == two.group_a.size() && two.group_b.front() < two.group_a.front());
  if (!swap) return two;
  std::swap(two.group_a, two.group_b);
  two.difference = -candidate.delta;
  return two;
}

// Sensors with the largest rejected group first: an edge speaks for one sensor only.
std::vector<TwoPoses> FindTwoPoses(const Split& split, std::vector<bool>& spoken_for) {
  std::vector<TwoPoses> found;
  for (;;) {
    Candidate best;
    for (int vertex = 0; vertex < split.problem.vertex_count; ++vertex) {
      Candidate candidate = CandidateAt(split, vertex, spoken_for);
      if (HasTwoPoses(split, candidate) && candidate.rejected.size() > best.rejected.size())
        best = std::move(candidate);
    }
    if (best.rejected.empty()) break;
    for (const std::size_t k : best.rejected) spoken_for[k] = true;
    found.push_back(Describe(split, best));
  }
  std::sort(found.begin(), found.end(),
            [](const TwoPoses& a, const TwoPoses& b) { return SensorBefore(a.sensor, b.sensor); });
  return found;
}

bool Connected(const Split& split, std::size_t without, int a, int b) {
  UnionFind sets(static_cast<std::size_t>(split.problem.vertex_count));
  for (std::size_t k = 0; k < split.robust.kept.size(); ++k)
    if (split.robust.kept[k] && k != without) sets.Join(split.problem.constraints[k].i, split.problem.constraints[k].j);
  return sets.Find(a) == sets.Find(b);
}

// Kept edges without which nothing contradicts the suspect either.
std::vector<EdgeId> AlternativesTo(const Split& split, std::size_t suspect) {
  const Constraint& c = split.problem.constraints[suspect];
  std::vector<std::size_t> alternatives;
  for (std::size_t k = 0; k < split.robust.kept.size(); ++k)
    if (split.robust.kept[k] && !Connected(split, k, c.i, c.j)) alternatives.push_back(k);
  return IdsOf(split, alternatives);
}

SuspectEdge DescribeEdge(const Split& split, std::size_t k) {
  SuspectEdge suspect;
  const GraphEdge& edge = split.EdgeOf(k);
  suspect.edge = edge.id;
  suspect.frame_a = edge.frame_a, suspect.frame_b = edge.frame_b;
  suspect.e = split.robust.checks.edges[k].jacobian.e;
  suspect.statistic = split.robust.checks.edges[k].t_squared;
  suspect.limit = split.robust.limit[k];
  return suspect;
}

// The split of a robust optimum into suspects.
Suspects SuspectsOf(const Graph& graph, const Problem& problem, const RobustOptimum& robust) {
  Suspects suspects;
  suspects.judged = robust.available;
  if (!robust.available) return suspects;
  const Split split{graph, problem, robust};
  std::vector<bool> spoken_for(robust.kept.size(), false);
  suspects.two_poses = FindTwoPoses(split, spoken_for);
  for (std::size_t k = 0; k < robust.kept.size(); ++k) {
    if (robust.kept[k] || spoken_for[k]) continue;
    suspects.edges.push_back(DescribeEdge(split, k));
    if (suspects.edges.size() <= kAlternativesOfMax) suspects.edges.back().alternatives = AlternativesTo(split, k);
  }
  std::sort(suspects.edges.begin(), suspects.edges.end(),
            [](const SuspectEdge& a, const SuspectEdge& b) { return a.edge < b.edge; });
  return suspects;
}

}  // namespace

Suspects FindSuspects(const Graph& graph, const GraphSolution& solution) {
  if (solution.dof <= 0 || solution.poses.size() != graph.sensors.size()) return {};
  const Problem problem = MakeProblem(graph);
  std::vector<int> dof;
  for (const Constraint& c : problem.constraints) dof.push_back(graph.edges[problem.edges_by_id[c.edge]].dof);
  return SuspectsOf(graph, problem, OptimizeRobustly(problem, SolvedPoses(graph, problem, solution), dof));
}

}  // namespace rigcal::graph
