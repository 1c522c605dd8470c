#include "server/graph/solved_poses.h"

#include <map>

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

}  // namespace rigcal::graph
