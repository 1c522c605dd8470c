#include "server/graph/solve/weak_edges.h"

#include <map>

#include "server/graph/solve/problem.h"
#include "server/model/edges/weak_edge.h"

namespace rigcal::graph {
namespace {

class Sensors {
 public:
  explicit Sensors(const std::vector<Edge>& edges) {
    for (const Edge& edge : edges)
      for (const SensorId& sensor : {edge.frame_a, edge.frame_b}) number_.emplace(sensor, number_.size());
  }
  [[nodiscard]] int Of(const SensorId& sensor) const { return static_cast<int>(number_.at(sensor)); }
  [[nodiscard]] std::size_t Count() const { return number_.size(); }

 private:
  std::map<SensorId, std::size_t> number_;
};

}  // namespace

std::set<EdgeId> WeakBesideBetter(const std::vector<Edge>& edges) {
  const Sensors sensors(edges);
  UnionFind held(sensors.Count());
  std::vector<const Edge*> weak;
  for (const Edge& edge : edges) {
    if (edge.state != EdgeState::kGood) continue;
    if (!WhyWeak(edge).empty())
      weak.push_back(&edge);
    else if (edge.uncertainty.rank == 6)
      held.Join(sensors.Of(edge.frame_a), sensors.Of(edge.frame_b));
  }
  std::set<EdgeId> beside;
  for (const Edge* edge : weak)
    if (held.Find(sensors.Of(edge->frame_a)) == held.Find(sensors.Of(edge->frame_b))) beside.insert(edge->id);
  return beside;
}

}  // namespace rigcal::graph
