#include <algorithm>
#include <string_view>

#include "server/graph/solve.h"

namespace rigcal::graph {
namespace {

bool IsNumeric(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

std::string_view WithoutLeadingZeros(std::string_view digits) {
  const std::size_t first = digits.find_first_not_of('0');
  return first == std::string_view::npos ? std::string_view() : digits.substr(first);
}

GraphEdge MeasurementOf(const Edge& edge) {
  return {edge.id,
          edge.frame_a,
          edge.frame_b,
          edge.T_a_b,
          edge.uncertainty.Omega,
          edge.uncertainty.rank,
          edge.uncertainty.dof,
          edge.session};
}

}  // namespace

bool SensorBefore(const SensorId& a, const SensorId& b) {
  const bool a_numeric = IsNumeric(a.str()), b_numeric = IsNumeric(b.str());
  if (a_numeric != b_numeric) return a_numeric;
  if (!a_numeric) return a < b;
  const std::string_view a_digits = WithoutLeadingZeros(a.str()), b_digits = WithoutLeadingZeros(b.str());
  if (a_digits.size() != b_digits.size()) return a_digits.size() < b_digits.size();
  if (a_digits != b_digits) return a_digits < b_digits;
  return a < b;  // "7" and "07"
}

Graph GraphOf(const std::vector<Edge>& edges, const SensorId& reference) {
  Graph graph;
  for (const Edge& edge : edges) {
    if (edge.state != EdgeState::kGood) continue;
    graph.edges.push_back(MeasurementOf(edge));
    graph.sensors.push_back(edge.frame_a);
    graph.sensors.push_back(edge.frame_b);
  }
  std::sort(graph.sensors.begin(), graph.sensors.end(), SensorBefore);
  graph.sensors.erase(std::unique(graph.sensors.begin(), graph.sensors.end()), graph.sensors.end());
  const bool present = std::binary_search(graph.sensors.begin(), graph.sensors.end(), reference, SensorBefore);
  if (present) {
    graph.reference = reference;
  } else if (!graph.sensors.empty()) {
    graph.reference = graph.sensors.front();
  }
  return graph;
}

}  // namespace rigcal::graph
