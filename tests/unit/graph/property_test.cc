// A thousand random graphs: batch, incremental and Ceres find one optimum of our cost, in any order of edges, from any
// reference, under any names, whichever way edges point.
#include <gtest/gtest.h>

#include "server/graph/live/live_solver.h"
#include "tests/unit/graph/ceres.h"
#include "tests/unit/graph/fixture.h"

namespace rigcal::graph {
namespace {

constexpr unsigned kGraphs = 1000;

RandomRig RigOf(unsigned seed) {
  std::mt19937 random(seed);
  const std::size_t vertices = 4 + random() % 37;
  const std::size_t edges = vertices - 1 + random() % (2 * vertices);
  return MakeRig(vertices, edges, seed + 1, 0.01, 0.01);
}

// Edges of a tree alone leave a cost of rounding errors.
double Scale(const GraphSolution& solution) { return std::max(solution.cost, 1e-3); }

TEST(GraphProperty, BatchEqualsCeres) {
  for (unsigned seed = 0; seed < kGraphs; ++seed) {
    const RandomRig rig = RigOf(seed);
    const GraphSolution ours = Solve(rig.graph);
    ASSERT_TRUE(ours.converged) << seed;
    GraphSolution start = ours;  // away from our optimum
    std::mt19937 random(seed);
    for (std::size_t v = 1; v < start.poses.size(); ++v)
      start.poses[v].T_ref_sensor = start.poses[v].T_ref_sensor * Se3::Exp(RandomVector(random, 0.003, 0.003));
    ASSERT_NEAR(ours.cost, SolveWithCeres(rig.graph, start).cost, 1e-9 * Scale(ours)) << seed;
  }
}

TEST(GraphProperty, IncrementalEqualsBatchInAnyOrder) {
  for (unsigned seed = 0; seed < kGraphs; ++seed) {
    RandomRig rig = RigOf(seed);
    const GraphSolution batch = Solve(rig.graph);
    std::mt19937 random(seed);
    if (seed % 2 == 1) std::shuffle(rig.graph.edges.begin(), rig.graph.edges.end(), random);
    LiveSolver live(rig.graph.reference);
    for (const GraphEdge& edge : rig.graph.edges) live.Add(edge);
    ASSERT_NEAR(live.Snapshot().cost, batch.cost, 1e-9 * Scale(batch)) << seed;
    for (std::size_t v = 0; v < batch.poses.size(); ++v) {
      const std::optional<Se3> T = live.PoseOf(batch.poses[v].sensor);
      ASSERT_TRUE(T.has_value()) << seed << " " << v;
      ASSERT_LT(Distance(*T, batch.poses[v].T_ref_sensor), 1e-5) << seed << " " << v;
    }
  }
}

TEST(GraphProperty, EveryUpdateEndsAtTheOptimumOfItsEdges) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    const RandomRig rig = RigOf(seed);
    LiveSolver live(rig.graph.reference);
    for (const GraphEdge& edge : rig.graph.edges) {
      live.Add(edge);
      const GraphSolution batch = Solve(live.graph());
      ASSERT_NEAR(live.Snapshot().cost, batch.cost, 1e-9 * Scale(batch)) << seed << " " << live.graph().edges.size();
    }
  }
}

TEST(GraphProperty, AnyReferenceAndAnyOrderGiveTheSameRig) {
  for (unsigned seed = 0; seed < kGraphs; ++seed) {
    RandomRig rig = RigOf(seed);
    const GraphSolution a = Solve(rig.graph);
    std::mt19937 random(seed);
    std::shuffle(rig.graph.edges.begin(), rig.graph.edges.end(), random);
    ASSERT_TRUE(SameBytes(a, Solve(rig.graph))) << seed;
    const std::size_t other = 1 + random() % (rig.graph.sensors.size() - 1);
    rig.graph.reference = rig.graph.sensors[other];
    const GraphSolution b = Solve(rig.graph);
    ASSERT_NEAR(a.cost, b.cost, 1e-9 * Scale(a)) << seed;
    for (std::size_t v = 0; v < a.poses.size(); ++v) {
      const Se3 T_other_v = a.poses[other].T_ref_sensor.Inverse() * a.poses[v].T_ref_sensor;
      ASSERT_LT(Distance(T_other_v, b.poses[v].T_ref_sensor), 1e-7) << seed << " " << v;
    }
  }
}

// Sensor v becomes names[v]; every edge gets another id; half of the edges are measured the other way round.
Graph Retold(const Graph& graph, const std::vector<SensorId>& names, std::mt19937& random) {
  Graph told = graph;
  for (GraphEdge& edge : told.edges) {
    edge.id = IdOf(100000 + random() % 1000000000);
    edge.frame_a = names[std::stoul(edge.frame_a.str())], edge.frame_b = names[std::stoul(edge.frame_b.str())];
    if (random() % 2 == 0) continue;
    edge.Omega = InverseInformation(edge.T_a_b, edge.Omega);
    edge.T_a_b = edge.T_a_b.Inverse();
    std::swap(edge.frame_a, edge.frame_b);
  }
  told.reference = names[0];
  return told;
}

TEST(GraphProperty, AnyNamesAndAnyDirectionsGiveTheSameRig) {
  for (unsigned seed = 0; seed < kGraphs; ++seed) {
    const RandomRig rig = RigOf(seed);
    const GraphSolution a = Solve(rig.graph);
    std::vector<SensorId> names = rig.graph.sensors;
    std::mt19937 random(seed);
    std::shuffle(names.begin(), names.end(), random);
    const GraphSolution b = Solve(Retold(rig.graph, names, random));
    ASSERT_NEAR(a.cost, b.cost, 1e-9 * Scale(a)) << seed;
    for (std::size_t v = 0; v < a.poses.size(); ++v) {
      const Se3& T = b.poses[std::stoul(names[v].str())].T_ref_sensor;
      ASSERT_LT(Distance(a.poses[v].T_ref_sensor, T), 1e-7) << seed << " " << v;
    }
  }
}

}  // namespace
}  // namespace rigcal::graph
