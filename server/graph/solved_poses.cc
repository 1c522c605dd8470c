#include "server/graph/solved_poses.h"

#include <map>

#include "server/graph/observability.h"
#include "server/graph/spanning_tree.h"

namespace rigcal::graph {

Poses SolvedPoses(const Graph& graph, const Problem& problem, const GraphSolution& solution) {
  std::map<SensorId, const Se3*> known;
  for (const SensorPose& pose : solution.poses)
    if (pose.known) known.emplace(pose.sensor, &pose.T_ref_sensor);
  Poses T_ref(static_cast<std::size_t>(problem.vertex_count));
  std::vector<bool> placed(T_ref.size(), false);
  for (std::size_t v = 0; v < T_ref.size(); ++v) {
    const auto found = known.find(graph.sensors[problem.sensor_of_vertex[v]]);
    placed[v] = found != known.end();
    if (placed[v]) T_ref[v] = *found->second;
  }
  return T_ref.empty() ? T_ref : GrowTree(problem, std::move(T_ref), std::move(placed));
}

std::unique_ptr<BlockCholesky<6>> FactorAt(const Problem& problem, const Poses& T_ref) {
  NormalEquations equations;
  Linearize(problem, T_ref, equations);
  AddPins(Observe(problem, T_ref).pins, equations.H);
  auto cholesky = MakeCholesky<6>(problem.pattern);
  return cholesky != nullptr && cholesky->Factor(equations.H, 0.0) ? std::move(cholesky) : nullptr;
}

}  // namespace rigcal::graph
