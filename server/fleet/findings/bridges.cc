#include "server/fleet/findings/bridges.h"

#include <algorithm>
#include <map>
#include <set>

namespace rigcal::fleet {
namespace {

struct Link {
  std::size_t to = 0, edge_idx = 0;
};

struct Links {
  std::size_t root = 0;  // the reference: the known sensor without uncertainty
  std::vector<SensorId> sensors;
  std::vector<std::vector<Link>> of;  // by sensor
};

Links LinksOf(const std::vector<Edge>& edges, const GraphSolution& solution) {
  Links links;
  std::map<SensorId, std::size_t> index;
  for (const SensorPose& pose : solution.poses) {
    if (!pose.known) continue;
    if (pose.covariance.isZero(0.0)) links.root = links.sensors.size();
    index.emplace(pose.sensor, links.sensors.size());
    links.sensors.push_back(pose.sensor);
  }
  links.of.resize(links.sensors.size());
  for (std::size_t k = 0; k < edges.size(); ++k) {
    const auto a = index.find(edges[k].frame_a), b = index.find(edges[k].frame_b);
    if (edges[k].state != EdgeState::kGood || a == index.end() || b == index.end()) continue;
    links.of[a->second].push_back({b->second, k});
    links.of[b->second].push_back({a->second, k});
  }
  return links;
}

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

// Tarjan's low-link over a depth-first walk without recursion: graphs may have thousands of sensors in a row.
struct Walk {
  std::vector<std::size_t> order, low, parent_edge, parent, next;
  std::vector<std::size_t> visited;  // in order of discovery
};

Walk WalkFrom(const Links& links, std::size_t root) {
  const std::size_t count = links.sensors.size();
  Walk walk{std::vector<std::size_t>(count, kNone), std::vector<std::size_t>(count, kNone),
            std::vector<std::size_t>(count, kNone), std::vector<std::size_t>(count, kNone),
            std::vector<std::size_t>(count, 0),     {}};
  std::vector<std::size_t> stack = {root};
  const auto discover = [&](std::size_t sensor) {
    walk.order[sensor] = walk.low[sensor] = walk.visited.size();
    walk.visited.push_back(sensor);
  };
  discover(root);
  while (!stack.empty()) {
    const std::size_t at = stack.back();
    if (walk.next[at] == links.of[at].size()) {
      stack.pop_back();
      if (!stack.empty()) walk.low[stack.back()] = std::min(walk.low[stack.back()], walk.low[at]);
      continue;
    }
    const Link link = links.of[at][walk.next[at]++];
    if (link.edge_idx == walk.parent_edge[at]) continue;
    if (walk.order[link.to] != kNone) {
      walk.low[at] = std::min(walk.low[at], walk.order[link.to]);
      continue;
    }
    walk.parent[link.to] = at;
    walk.parent_edge[link.to] = link.edge_idx;
    discover(link.to);
    stack.push_back(link.to);
  }
  return walk;
}

}  // namespace

Bridges FindBridges(const std::vector<Edge>& edges, const GraphSolution& solution) {
  const Links links = LinksOf(edges, solution);
  Bridges bridges;
  if (links.sensors.empty()) return bridges;
  const Walk walk = WalkFrom(links, links.root);
  std::vector<bool> behind(links.sensors.size(), false);
  for (const std::size_t sensor : walk.visited) {
    if (sensor == links.root) continue;
    const bool by_bridge = walk.low[sensor] == walk.order[sensor];
    if (by_bridge) bridges.edges.insert(edges[walk.parent_edge[sensor]].id);
    behind[sensor] = by_bridge || behind[walk.parent[sensor]];
    if (behind[sensor]) bridges.sensors.push_back(links.sensors[sensor]);
  }
  std::sort(bridges.sensors.begin(), bridges.sensors.end());
  return bridges;
}

}  // namespace rigcal::fleet
