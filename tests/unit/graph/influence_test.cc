// What each edge does to the solution, and what the others know of it.
#include <gmock/gmock.h>

#include <set>

#include "server/graph/insight/insight.h"
#include "server/model/graph/unchecked.h"
#include "tests/unit/graph/fixture.h"

namespace rigcal::graph {
namespace {

TEST(Influence, IsTheSolutionWithoutTheEdge) {
  const RandomRig rig = MakeRig(6, 12, 13, 2e-4, 2e-4);
  const GraphSolution with = Solve(rig.graph);
  const Influences influences = InfluenceOfEdges(rig.graph, with);
  ASSERT_TRUE(influences.judged);
  ASSERT_EQ(influences.edges.size(), rig.graph.edges.size());
  int checked = 0;
  for (const EdgeInfluence& influence : influences.edges) {
    if (!influence.checked) continue;
    ++checked;
    Graph graph = rig.graph;
    graph.edges.erase(std::find_if(graph.edges.begin(), graph.edges.end(),
                                   [&](const GraphEdge& edge) { return edge.id == influence.edge; }));
    const GraphSolution without = Solve(graph);
    const auto sensor = std::stoul(influence.most_moved.str());
    const Vector6d move = (with.poses[sensor].T_ref_sensor.Inverse() * without.poses[sensor].T_ref_sensor).Log();
    EXPECT_LT((move - influence.move).norm(), 0.01 * move.norm());
    EXPECT_NEAR(influence.t_squared, with.cost - without.cost, 0.01 * with.cost);
    EXPECT_NEAR(influence.move_sigmas, std::sqrt(move.dot(with.poses[sensor].covariance.ldlt().solve(move))),
                0.01 * influence.move_sigmas);
    const GraphEdge& edge = EdgeBy(rig.graph, influence.edge);
    const auto pose = [&](const SensorId& name) { return without.poses[std::stoul(name.str())].T_ref_sensor; };
    const Vector6d off = (edge.T_a_b.Inverse() * pose(edge.frame_a).Inverse() * pose(edge.frame_b)).Log();
    EXPECT_LT((off - influence.off).norm(), 0.01 * off.norm());
  }
  EXPECT_GT(checked, 8);
}

// The sigmas are those that people are told.
TEST(Influence, CountsInTheSigmasOfTheSolution) {
  const RandomRig rig = FullRig(5, 14);
  GraphSolution solution = Solve(rig.graph);
  const Influences one = InfluenceOfEdges(rig.graph, solution);
  for (SensorPose& pose : solution.poses) pose.covariance *= 4.0;
  const Influences half = InfluenceOfEdges(rig.graph, solution);
  for (std::size_t k = 0; k < one.edges.size(); ++k)
    EXPECT_NEAR(half.edges[k].move_sigmas, one.edges[k].move_sigmas / 2.0, 1e-9);
}

TEST(Influence, OfEqualEdgesTheWrongOneMovesItsSensorMost) {
  RandomRig rig = FullRig(6, 15);
  for (GraphEdge& edge : rig.graph.edges) edge.Omega = 2.5e5 * Matrix6d::Identity();
  GraphEdge& wrong = rig.graph.edges[14];  // of sensors 4 and 5
  wrong.T_a_b = wrong.T_a_b * Se3::Exp(0.1 * Vector6d::Ones());
  const Influences influences = InfluenceOfEdges(rig.graph, Solve(rig.graph));
  const auto worst = std::max_element(influences.edges.begin(), influences.edges.end(),
                                      [](const auto& a, const auto& b) { return a.move_sigmas < b.move_sigmas; });
  EXPECT_EQ(worst->edge, wrong.id);
  EXPECT_TRUE(worst->most_moved == Name(4) || worst->most_moved == Name(5));
}

TEST(Influence, ABridgeIsNotChecked) {
  const RandomRig rig = MakeRig(4, 3, 14);
  const Influences influences = InfluenceOfEdges(rig.graph, Solve(rig.graph));
  ASSERT_EQ(influences.edges.size(), 3u);
  for (const EdgeInfluence& influence : influences.edges) EXPECT_FALSE(influence.checked);
  const Influences none = InfluenceOfEdges(Graph(), Solve(Graph()));
  EXPECT_TRUE(none.edges.empty());
}

// Two edges tie the fourth sensor, each in what the other does not see: a loop that checks nothing.
TEST(Influence, EdgesThatCompleteEachOtherAreNotChecked) {
  RandomRig rig = FullRig(4, 15);
  std::vector<GraphEdge>& edges = rig.graph.edges;  // 01 02 03 12 13 23
  edges.erase(edges.begin() + 2);
  for (const std::size_t k : {3U, 4U}) {
    Vector6d seen = 1e6 * Vector6d::Ones();
    (k == 3 ? seen.head<3>() : seen.tail<3>()).setZero();
    edges[k].Omega = seen.asDiagonal();
    edges[k].rank = 3;
  }
  GraphSolution solution = Solve(rig.graph);
  ASSERT_EQ(solution.dof, 6);
  EXPECT_TRUE(UncheckedEdges(solution).empty());  // not known yet
  solution.influences = InfluenceOfEdges(rig.graph, solution);
  EXPECT_EQ(UncheckedEdges(solution), (std::set<EdgeId>{edges[3].id, edges[4].id}));
}

// The edge left out, how well the others tell its two sensors to each other.
TEST(OtherPaths, AreWhatTheSolutionWithoutTheEdgeKnows) {
  const RandomRig rig = FullRig(5, 31);
  const OtherPaths others = OtherPathsOf(rig.graph, Solve(rig.graph));
  ASSERT_EQ(others.size(), rig.graph.edges.size());
  for (std::size_t k = 0; k < rig.graph.edges.size(); ++k) {
    Graph graph = rig.graph;
    const GraphEdge edge = graph.edges[k];
    graph.edges.erase(graph.edges.begin() + static_cast<std::ptrdiff_t>(k));
    const auto known = Relative(graph, Solve(graph), edge.frame_a, edge.frame_b);
    ASSERT_TRUE(known);
    const Matrix6d off = others.at(edge.id) * known->covariance - Matrix6d::Identity();
    EXPECT_LT(off.cwiseAbs().maxCoeff(), 0.02);
  }
}

TEST(OtherPaths, SayNothingOfWhatTheyDoNotMeasure) {
  RandomRig rig = FullRig(3, 32);  // 01 02 12
  for (GraphEdge& edge : rig.graph.edges) edge.Omega = 1e6 * Matrix6d::Identity();
  rig.graph.edges[2].Omega.topLeftCorner<3, 3>().setZero();
  rig.graph.edges[2].rank = 3;
  const OtherPaths others = OtherPathsOf(rig.graph, Solve(rig.graph));
  for (const std::size_t k : {0U, 1U}) {
    const Matrix6d& known = others.at(rig.graph.edges[k].id);
    EXPECT_LT((known.topLeftCorner<3, 3>().norm()), 1.0);
    EXPECT_GT((known.bottomRightCorner<3, 3>().norm()), 1e5);
  }
  EXPECT_TRUE(OtherPathsOf(rig.graph, GraphSolution()).empty());
}

TEST(Influence, SaysWhatItLeavesOut) {
  const RandomRig large = MakeRig(kInfluenceSensorsMax + 1, 2 * kInfluenceSensorsMax, 16);
  const Influences influences = InfluenceOfEdges(large.graph, Solve(large.graph));
  EXPECT_FALSE(influences.judged);
  EXPECT_TRUE(influences.edges.empty());
  EXPECT_THAT(influences.why_not, testing::HasSubstr("up to 150 sensors and 1500 edges, and this graph has 151"));
  const RandomRig rig = MakeRig(4, 6, 17);
  EXPECT_FALSE(InfluenceOfEdges(rig.graph, GraphSolution()).judged);
}

}  // namespace
}  // namespace rigcal::graph
