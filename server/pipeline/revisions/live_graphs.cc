#include "server/pipeline/revisions/live_graphs.h"

#include <algorithm>
#include <set>
#include <vector>

namespace rigcal::pipeline {
namespace {

// A burst larger than this, and than the graph at hand, is solved at once.
constexpr std::size_t kOneByOneMax = 32;
// Changes after which nothing but a batch will do (an edge of a low rank is enough) are taken together after so many.
constexpr std::size_t kBatchesMax = 2;

std::vector<EdgeId> SortedIds(const std::vector<GraphEdge>& edges) {
  std::vector<EdgeId> ids;
  ids.reserve(edges.size());
  for (const GraphEdge& edge : edges) ids.push_back(edge.id);
  std::sort(ids.begin(), ids.end());
  return ids;
}

// Ids of a that are not in b; both sorted.
std::vector<EdgeId> Without(const std::vector<EdgeId>& a, const std::vector<EdgeId>& b) {
  std::vector<EdgeId> rest;
  std::set_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(rest));
  return rest;
}

// Whether it holds a sensor that is gone: one does not leave it otherwise.
bool HoldsOthers(const graph::LiveSolver& solver, const std::vector<SensorId>& sensors) {
  const std::set<SensorId> wanted(sensors.begin(), sensors.end());
  const auto& held = solver.graph().sensors;
  return std::any_of(held.begin(), held.end(), [&](const SensorId& sensor) { return !wanted.contains(sensor); });
}

void StartAnew(const RobotGraph& loaded, LiveGraph& live) {
  live.solver = std::make_unique<graph::LiveSolver>(loaded.graph);
}

}  // namespace

void TakeNewEdges(const RobotGraph& loaded, LiveGraph& live) {
  live.watermark = loaded.watermark;
  live.standing_watermark = loaded.standing_watermark;
  const graph::LiveSolver* solver = live.solver.get();
  const std::vector<EdgeId> held = solver == nullptr ? std::vector<EdgeId>() : SortedIds(solver->graph().edges);
  const std::vector<EdgeId> wanted = SortedIds(loaded.graph.edges);
  const std::vector<EdgeId> added = Without(wanted, held), removed = Without(held, wanted);
  if (solver == nullptr || solver->graph().reference != loaded.graph.reference ||
      HoldsOthers(*solver, loaded.graph.sensors) || added.size() > std::max(kOneByOneMax, held.size()) ||
      removed.size() > kOneByOneMax)
    return StartAnew(loaded, live);
  for (const SensorId& sensor : loaded.graph.sensors) live.solver->AddSensor(sensor);
  std::size_t batches = 0;
  for (const GraphEdge& edge : loaded.graph.edges) {
    if (!std::binary_search(added.begin(), added.end(), edge.id)) continue;
    if (live.solver->Add(edge).batch && ++batches > kBatchesMax) return StartAnew(loaded, live);
  }
  // After what takes their place: so the graph does not fall apart meanwhile.
  for (const EdgeId& id : removed)
    if (live.solver->Remove(id).batch && ++batches > kBatchesMax) return StartAnew(loaded, live);
}

LiveGraph& LiveGraphs::Of(const RobotId& robot) {
  const std::lock_guard lock(mutex_);
  return graphs_[robot];
}

}  // namespace rigcal::pipeline
