#include "server/graph/solve.h"

#include <algorithm>
#include <map>

#include "server/graph/conjugate_gradients.h"
#include "server/graph/optimize_graph.h"
#include "server/graph/sensor_order.h"
#include "server/graph/start_poses.h"

namespace rigcal::graph {
namespace {

constexpr double kTreeIsGood_rad = 0.5;  // below this residual rotation everywhere, a tree lies in the optimum's basin

bool StartSuffices(const Problem& problem, const std::vector<Vector6d>& residuals) {
  if (static_cast<int>(problem.constraints.size()) == problem.free_count()) return true;  // no loop: it is the optimum
  if (problem.free_count() > kBlocksDenseMax && !PrefersConjugateGradients(problem)) return false;
  return std::all_of(residuals.begin(), residuals.end(),
                     [](const Vector6d& e) { return e.tail<3>().norm() < kTreeIsGood_rad; });
}

// The start of the lowest weighted cost; earlier ones win ties.
Poses BestStart(const Problem& problem, std::vector<Poses> starts) {
  if (starts.size() == 1) return std::move(starts[0]);
  std::size_t best = 0;
  double best_cost = Cost(problem, starts[0]);
  for (std::size_t k = 1; k < starts.size(); ++k) {
    const double cost = Cost(problem, starts[k]);
    if (cost < best_cost) best = k, best_cost = cost;
  }
  return std::move(starts[best]);
}

// Poses of `previous` where it knows them; the other sensors hang on them by their best edges.
Poses WarmStart(const Graph& graph, const Problem& problem, const GraphSolution& previous) {
  std::map<SensorId, const SensorPose*> known;
  for (const SensorPose& pose : previous.poses)
    if (pose.known) known.emplace(pose.sensor, &pose);
  const auto reference = known.find(graph.reference);
  const auto count = static_cast<std::size_t>(problem.vertex_count);
  Poses T_ref(count);
  std::vector<bool> placed(count, false);
  if (reference == known.end()) return GrowTree(problem, T_ref, placed);
  const Se3 T_new_old = reference->second->T_ref_sensor.Inverse();  // the reference may be another one than before
  for (std::size_t v = 1; v < count; ++v) {
    const auto found = known.find(graph.sensors[problem.sensor_of_vertex[v]]);
    if (found == known.end()) continue;
    T_ref[v] = (T_new_old * found->second->T_ref_sensor).Normalized();
    placed[v] = true;
  }
  return GrowTree(problem, std::move(T_ref), std::move(placed));
}

GraphSolution SolveFrom(const Graph& graph, const GraphSolution* previous, const SolveOptions& options) {
  const Problem problem = MakeProblem(graph);
  if (problem.vertex_count == 0) return WithoutReference(graph, problem);
  const Poses tree = SpanningTreePoses(problem);
  std::vector<Poses> starts;
  if (previous != nullptr) starts.push_back(WarmStart(graph, problem, *previous));
  starts.push_back(tree);
  const std::vector<Vector6d> tree_residuals = Residuals(problem, tree);
  if (!StartSuffices(problem, previous == nullptr ? tree_residuals : Residuals(problem, starts.front())))
    if (std::optional<Poses> chordal = ChordalPoses(problem)) starts.push_back(std::move(*chordal));
  return OptimizeGraph(graph, problem, tree_residuals, BestStart(problem, std::move(starts)), options);
}

}  // namespace

GraphSolution Solve(const Graph& graph, const SolveOptions& options) { return SolveFrom(graph, nullptr, options); }

GraphSolution Update(const Graph& graph, const GraphSolution& previous, const SolveOptions& options) {
  return SolveFrom(graph, &previous, options);
}

}  // namespace rigcal::graph
