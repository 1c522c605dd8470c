#include "server/graph/solve/weak_edges.h"

#include <algorithm>
#include <limits>

#include "server/graph/solve/problem.h"
#include "server/model/edges/weak_edge.h"

namespace rigcal::graph {
namespace {

struct Dated {
  const Edge* edge = nullptr;
  std::int64_t at_ns = 0;
};

bool Holds(const Edge& edge) {
  return edge.state == EdgeState::kGood && edge.uncertainty.rank == 6 &&
         edge.uncertainty.source != UncertaintySource::kAssumed;
}

// The latest first.
std::vector<Dated> LatestFirst(const std::vector<const Edge*>& edges, const std::map<EdgeId, Stamp>& measured_at) {
  std::vector<Dated> dated;
  for (const Edge* edge : edges) {
    const auto at = measured_at.find(edge->id);
    dated.push_back({edge, at == measured_at.end() ? std::numeric_limits<std::int64_t>::min() : at->second.ns});
  }
  std::sort(dated.begin(), dated.end(), [](const Dated& x, const Dated& y) { return x.at_ns > y.at_ns; });
  return dated;
}

std::map<SensorId, int> Numbered(const std::vector<Edge>& edges) {
  std::map<SensorId, int> number;
  for (const Edge& edge : edges)
    for (const SensorId& sensor : {edge.frame_a, edge.frame_b}) number.emplace(sensor, static_cast<int>(number.size()));
  return number;
}

}  // namespace

std::set<EdgeId> WeakBesideBetter(const std::vector<Edge>& edges, const std::map<EdgeId, Stamp>& measured_at) {
  std::vector<const Edge*> weak, better;
  for (const Edge& edge : edges)
    if (!WhyWeak(edge).empty())
      weak.push_back(&edge);
    else if (Holds(edge))
      better.push_back(&edge);
  if (weak.empty()) return {};
  const std::map<SensorId, int> number = Numbered(edges);
  const std::vector<Dated> holding = LatestFirst(better, measured_at);
  UnionFind held(number.size());
  auto next = holding.begin();
  std::set<EdgeId> beside;
  for (const Dated& one : LatestFirst(weak, measured_at)) {
    for (; next != holding.end() && next->at_ns >= one.at_ns; ++next)
      held.Join(number.at(next->edge->frame_a), number.at(next->edge->frame_b));
    if (held.Find(number.at(one.edge->frame_a)) == held.Find(number.at(one.edge->frame_b))) beside.insert(one.edge->id);
  }
  return beside;
}

std::vector<Edge> WithoutEdges(std::vector<Edge> edges, const std::set<EdgeId>& without) {
  std::erase_if(edges, [&](const Edge& edge) { return without.contains(edge.id); });
  return edges;
}

}  // namespace rigcal::graph
