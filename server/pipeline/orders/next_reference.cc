#include "server/pipeline/orders/next_reference.h"

#include <algorithm>
#include <map>
#include <set>

namespace rigcal::pipeline {
namespace {

// By edges, however many lie between; the reference itself too.
std::set<SensorId> TiedToReference(const Graph& graph) {
  std::multimap<SensorId, SensorId> neighbours;
  for (const GraphEdge& edge : graph.edges) {
    neighbours.emplace(edge.frame_a, edge.frame_b);
    neighbours.emplace(edge.frame_b, edge.frame_a);
  }
  std::set<SensorId> tied = {graph.reference};
  std::vector<SensorId> open = {graph.reference};
  while (!open.empty()) {
    const auto [first, last] = neighbours.equal_range(open.back());
    open.pop_back();
    for (auto next = first; next != last; ++next)
      if (tied.insert(next->second).second) open.push_back(next->second);
  }
  return tied;
}

std::string ListedSensors(const std::vector<SensorId>& sensors) {
  constexpr std::size_t kNamesMax = 8;
  std::string text;
  for (std::size_t i = 0; i < std::min(sensors.size(), kNamesMax); ++i) text += (i == 0 ? "" : ", ") + sensors[i].str();
  return sensors.size() <= kNamesMax ? text : text + " and " + std::to_string(sensors.size() - kNamesMax) + " more";
}

}  // namespace

Status CheckNextReference(const Graph& before, const Graph& after) {
  const std::string gone = before.reference.str();
  const std::string what = "sensor " + gone + " is the reference that all others are told in, and ";
  if (after.edges.empty())
    return Fail(ErrorCode::kConflict, what + "no good edge ties any two of the others",
                "Push a session, or edges, that tie the others to each other; then retire " + gone + ".");
  const std::set<SensorId> tied = TiedToReference(after);
  std::vector<SensorId> lost;
  for (const SensorId& sensor : TiedToReference(before))
    if (sensor != before.reference && !tied.contains(sensor)) lost.push_back(sensor);
  if (lost.empty()) return {};
  const std::string others = ListedSensors(lost), next = after.reference.str();
  return Fail(
      ErrorCode::kConflict, what + "nothing else ties " + others + " to " + next,
      "Push a session, or edges, that tie " + others + " to " + next + " without it; then retire " + gone + ".");
}

}  // namespace rigcal::pipeline
