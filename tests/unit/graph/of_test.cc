#include <gtest/gtest.h>

#include <algorithm>

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

// Of a session, seen in five directions only, or by clouds that overlap by so much.
Edge WeakBetween(const std::string& a, const std::string& b, double overlap_ratio = 1.0) {
  Edge edge = EdgeBetween(a, b);
  edge.session = SessionId("visit");
  if (overlap_ratio < 1.0)
    edge.figures["overlap_ratio"] = overlap_ratio;
  else
    edge.uncertainty.rank = 5;
  return edge;
}

std::size_t EdgesIn(std::vector<Edge> edges) {
  const std::size_t count = GraphOf(edges, SensorId()).edges.size();
  std::reverse(edges.begin(), edges.end());
  EXPECT_EQ(GraphOf(edges, SensorId()).edges.size(), count);
  return count;
}

TEST(GraphOf, LeavesWeakEdgesOutWhoseSensorsBetterOnesHold) {
  const std::vector<Edge> held = {EdgeBetween("a", "b"), EdgeBetween("b", "c")};
  const auto with = [&](const Edge& edge) {
    std::vector<Edge> edges = held;
    edges.push_back(edge);
    return EdgesIn(edges);
  };
  EXPECT_EQ(with(WeakBetween("a", "c")), 2U);
  EXPECT_EQ(with(WeakBetween("a", "c", 0.31)), 2U);
  EXPECT_EQ(with(WeakBetween("a", "c", 0.45)), 3U);
  EXPECT_EQ(with(WeakBetween("c", "d")), 3U) << "nothing better ties d";
  EXPECT_EQ(EdgesIn({WeakBetween("a", "b"), WeakBetween("b", "c"), WeakBetween("a", "c")}), 3U);
}

TEST(GraphOf, TakesAPushedEdgeHoweverFewDirectionsItSees) {
  Edge pushed = WeakBetween("a", "c");
  pushed.session = SessionId();
  EXPECT_EQ(EdgesIn({EdgeBetween("a", "b"), EdgeBetween("b", "c"), pushed}), 3U);
}

TEST(GraphOf, APushedEdgeThatSeesAPartHoldsNoSensor) {
  Edge part = EdgeBetween("b", "c");
  part.uncertainty.rank = 3;
  EXPECT_EQ(EdgesIn({EdgeBetween("a", "b"), part, WeakBetween("a", "c", 0.3)}), 3U);
}

}  // namespace
}  // namespace rigcal::graph
