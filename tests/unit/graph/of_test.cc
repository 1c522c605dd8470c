#include <gtest/gtest.h>

#include "tests/unit/graph/fixture.h"

namespace rigcal::graph {
namespace {

Edge EdgeBetween(const std::string& a, const std::string& b, EdgeState state = EdgeState::kGood) {
  Edge edge;
  edge.id = EdgeId(Sha256Of(a + b).str());
  edge.frame_a = SensorId(a), edge.frame_b = SensorId(b);
  edge.uncertainty = FromInformation(4.0 * Matrix6d::Identity(), UncertaintySource::kGiven, 12);
  edge.state = state;
  return edge;
}

std::vector<std::string> NamesOf(const Graph& graph) {
  std::vector<std::string> names;
  for (const SensorId& sensor : graph.sensors) names.push_back(sensor.str());
  return names;
}

TEST(GraphOf, NumericNamesComeFirstAndAsNumbers) {
  const Graph graph = GraphOf(
      {EdgeBetween("10", "9"), EdgeBetween("b", "007"), EdgeBetween("a", "2"), EdgeBetween("7", "2x")}, SensorId());
  EXPECT_EQ(NamesOf(graph), (std::vector<std::string>{"2", "007", "7", "9", "10", "2x", "a", "b"}));
  EXPECT_EQ(graph.reference.str(), "2");
}

TEST(GraphOf, TakesTheReferenceAskedForIfItIsThere) {
  const std::vector<Edge> edges = {EdgeBetween("left", "right")};
  EXPECT_EQ(GraphOf(edges, SensorId("right")).reference.str(), "right");
  EXPECT_EQ(GraphOf(edges, SensorId("elsewhere")).reference.str(), "left");
  EXPECT_TRUE(GraphOf({}, SensorId("right")).reference.empty());
}

TEST(GraphOf, LeavesFailedEdgesOutAndKeepsWhatSolvingNeeds) {
  const Graph graph = GraphOf({EdgeBetween("a", "b"), EdgeBetween("b", "c", EdgeState::kFailed)}, SensorId());
  EXPECT_EQ(NamesOf(graph), (std::vector<std::string>{"a", "b"}));
  ASSERT_EQ(graph.edges.size(), 1U);
  EXPECT_EQ(graph.edges[0].rank, 6);
  EXPECT_EQ(graph.edges[0].dof, 12);
  EXPECT_EQ(graph.edges[0].Omega, 4.0 * Matrix6d::Identity());
}

}  // namespace
}  // namespace rigcal::graph
