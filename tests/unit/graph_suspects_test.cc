#include <gmock/gmock.h>

#include "server/graph/cycles.h"
#include "server/graph/edge_influence.h"
#include "server/graph/suspects.h"
#include "tests/unit/graph_fixture.h"

namespace rigcal::graph {
namespace {

using testing::ElementsAre;
using testing::UnorderedElementsAre;

// Every pair of `count` sensors once.
RandomRig FullRig(std::size_t count, unsigned seed) {
  RandomRig rig = MakeRig(count, count - 1, seed);
  rig.graph.edges.clear();
  std::mt19937 random(seed + 1);
  std::size_t k = 0;
  for (std::size_t a = 0; a < count; ++a)
    for (std::size_t b = a + 1; b < count; ++b) {
      const Matrix6d Omega = RandomInformation(random, 0.002, 0.002);
      const Se3 T = rig.truth[a].Inverse() * rig.truth[b] * Se3::Exp(DrawError(random, Omega));
      rig.graph.edges.push_back(MakeEdge(k++, a, b, T, Omega));
    }
  return rig;
}

Suspects Find(const Graph& graph) { return FindSuspects(graph, Solve(graph)); }

void Spoil(GraphEdge& edge, const Vector6d& error) { edge.T_a_b = edge.T_a_b * Se3::Exp(error); }

TEST(Suspects, GoodEdgesHaveNone) {
  const Suspects suspects = Find(FullRig(6, 1).graph);
  EXPECT_TRUE(suspects.judged);
  EXPECT_TRUE(suspects.edges.empty());
  EXPECT_TRUE(suspects.two_poses.empty());
}

TEST(Suspects, NamesTheWrongEdgesAndHowFarTheyAreOff) {
  RandomRig rig = FullRig(6, 2);
  std::mt19937 random(3);
  const Vector6d error = RandomVector(random, 0.05, 0.1);
  Spoil(rig.graph.edges[4], error);
  Spoil(rig.graph.edges[11], RandomVector(random, 0.05, 0.1));
  const Suspects suspects = Find(rig.graph);
  std::vector<EdgeId> named;
  for (const SuspectEdge& suspect : suspects.edges) {
    named.push_back(suspect.edge);
    EXPECT_GT(suspect.statistic, suspect.limit);
    EXPECT_TRUE(suspect.alternatives.empty());
    EXPECT_TRUE(suspect.edge != IdOf(4) || (suspect.e + error).norm() < 0.03);
  }
  EXPECT_THAT(named, UnorderedElementsAre(IdOf(4), IdOf(11)));
  EXPECT_TRUE(suspects.two_poses.empty());
}

TEST(Suspects, TheSolutionStaysThatOfAllEdges) {
  RandomRig rig = FullRig(5, 2);
  Spoil(rig.graph.edges[3], 0.1 * Vector6d::Ones());
  const GraphSolution before = Solve(rig.graph);
  ASSERT_FALSE(FindSuspects(rig.graph, before).edges.empty());
  EXPECT_TRUE(SameBytes(before, Solve(rig.graph)));
}

// Half of sensor 3's edges measured it where it was before somebody moved it.
TEST(Suspects, ASensorWithTwoPoses) {
  RandomRig rig = FullRig(7, 5);
  Vector6d moved;
  moved << 0.03, -0.02, 0.01, 0.02, 0.0, 0.04;
  std::vector<EdgeId> before, after;
  for (GraphEdge& edge : rig.graph.edges) {
    if (edge.frame_a != Name(3) && edge.frame_b != Name(3)) continue;
    if (before.size() == 3) {
      after.push_back(edge.id);
      continue;
    }
    before.push_back(edge.id);
    edge.T_a_b = edge.frame_b == Name(3) ? edge.T_a_b * Se3::Exp(moved) : Se3::Exp(moved).Inverse() * edge.T_a_b;
  }
  const Suspects suspects = Find(rig.graph);
  ASSERT_EQ(suspects.two_poses.size(), 1u);
  const TwoPoses& two = suspects.two_poses[0];
  EXPECT_EQ(two.sensor, Name(3));
  std::sort(before.begin(), before.end());
  std::sort(after.begin(), after.end());
  EXPECT_EQ(std::min(two.group_a, two.group_b), std::min(before, after));
  EXPECT_EQ(std::max(two.group_a, two.group_b), std::max(before, after));
  const double sign = two.group_b == before ? 1.0 : -1.0;
  EXPECT_LT((two.difference - sign * moved).norm(), 0.02);
  EXPECT_TRUE(suspects.edges.empty());
}

// Two edges alone tie sensor 4: which one is wrong cannot be known.
TEST(Suspects, OneOfTwoEdgesHasTwoPoses) {
  RandomRig rig = FullRig(5, 6);
  auto& edges = rig.graph.edges;
  edges.erase(std::remove_if(edges.begin(), edges.end(),
                             [](const GraphEdge& e) {
                               return e.frame_b == Name(4) && (e.frame_a == Name(0) || e.frame_a == Name(1));
                             }),
              edges.end());
  const auto last = std::find_if(edges.begin(), edges.end(),
                                 [](const GraphEdge& e) { return e.frame_a == Name(2) && e.frame_b == Name(4); });
  Spoil(*last, 0.1 * Vector6d::Ones());
  const Suspects suspects = Find(rig.graph);
  ASSERT_EQ(suspects.two_poses.size(), 1u);
  EXPECT_EQ(suspects.two_poses[0].sensor, Name(4));
  EXPECT_TRUE(suspects.edges.empty());
}

TEST(Suspects, ALoopBlamesOneOfItsEdges) {
  RandomRig rig = FullRig(3, 7);
  Spoil(rig.graph.edges[1], 0.1 * Vector6d::Ones());
  const Suspects suspects = Find(rig.graph);
  ASSERT_EQ(suspects.edges.size(), 1u);
  EXPECT_EQ(suspects.edges[0].alternatives.size(), 2u);
  EXPECT_TRUE(suspects.two_poses.empty());
}

TEST(Suspects, OrderOfEdgesDoesNotMatter) {
  RandomRig rig = FullRig(6, 8);
  Spoil(rig.graph.edges[2], 0.05 * Vector6d::Ones());
  Graph shuffled = rig.graph;
  std::reverse(shuffled.edges.begin(), shuffled.edges.end());
  const Suspects a = Find(rig.graph), b = Find(shuffled);
  ASSERT_EQ(a.edges.size(), 1u);
  ASSERT_EQ(b.edges.size(), 1u);
  EXPECT_EQ(a.edges[0].edge, b.edges[0].edge);
  EXPECT_EQ(a.edges[0].e, b.edges[0].e);
}

TEST(Suspects, OddGraphs) {
  EXPECT_FALSE(Find(Graph()).judged);
  RandomRig single = MakeRig(2, 1, 9);
  EXPECT_FALSE(Find(single.graph).judged);  // nothing to compare
  RandomRig rig = FullRig(4, 10);
  rig.graph.sensors.push_back(Name(8));
  rig.graph.sensors.push_back(Name(9));
  rig.graph.edges.push_back(MakeEdge(80, 8, 9, Se3(), 1e4 * Matrix6d::Identity()));
  rig.graph.edges.push_back(MakeEdge(81, 1, 1, Se3(), 1e4 * Matrix6d::Identity()));
  EXPECT_TRUE(Find(rig.graph).edges.empty());
  // The same pair twice, the second by 180 degrees off: one of the two, or the triangle speaks.
  GraphEdge twice = rig.graph.edges[0];
  twice.id = IdOf(82);
  twice.T_a_b = twice.T_a_b * Se3{Eigen::Vector3d::Zero(), Eigen::Quaterniond(0, 0, 0, 1)};
  rig.graph.edges.push_back(twice);
  const Suspects suspects = Find(rig.graph);
  ASSERT_EQ(suspects.edges.size(), 1u);
  EXPECT_EQ(suspects.edges[0].edge, IdOf(82));
}

TEST(Suspects, DeficientEdgesAreJudgedByWhatTheySee) {
  RandomRig rig = FullRig(5, 12);
  for (GraphEdge& edge : rig.graph.edges)
    if (edge.id == IdOf(1) || edge.id == IdOf(6)) {
      edge.Omega.setZero();
      edge.Omega.diagonal() << 1e6, 1e6, 0, 0, 0, 1e6;
      edge.rank = 3;
      edge.T_a_b = rig.truth[std::stoul(edge.frame_a.str())].Inverse() * rig.truth[std::stoul(edge.frame_b.str())] *
                   Se3::Exp(0.4 * Vector6d::Unit(2));
    }
  EXPECT_TRUE(Find(rig.graph).edges.empty());
  for (GraphEdge& edge : rig.graph.edges)
    if (edge.id == IdOf(6)) Spoil(edge, 0.1 * Vector6d::Unit(0));
  const Suspects suspects = Find(rig.graph);
  ASSERT_EQ(suspects.edges.size(), 1u);
  EXPECT_EQ(suspects.edges[0].edge, IdOf(6));
}

TEST(Influence, IsTheSolutionWithoutTheEdge) {
  const RandomRig rig = MakeRig(6, 12, 13, 2e-4, 2e-4);
  const GraphSolution with = Solve(rig.graph);
  const auto influences = InfluenceOfEdges(rig.graph, with);
  ASSERT_EQ(influences.size(), rig.graph.edges.size());
  int checked = 0;
  for (const EdgeInfluence& influence : influences) {
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
  }
  EXPECT_GT(checked, 8);
}

TEST(Influence, ABridgeIsNotChecked) {
  const RandomRig rig = MakeRig(4, 3, 14);
  for (const EdgeInfluence& influence : InfluenceOfEdges(rig.graph, Solve(rig.graph))) EXPECT_FALSE(influence.checked);
  EXPECT_TRUE(InfluenceOfEdges(Graph(), Solve(Graph())).empty());
}

TEST(Cycles, LoopsAndTriangles) {
  const RandomRig rig = FullRig(4, 15);  // 3 fundamental loops, which are triangles with vertex 0; 1 more triangle
  const auto cycles = FindCycles(rig.graph);
  ASSERT_EQ(cycles.size(), 4u);
  for (const CycleResidual& cycle : cycles) {
    ASSERT_EQ(cycle.edges.size(), 3u);
    EXPECT_TRUE(cycle.tested);
    EXPECT_LT(cycle.statistic, 30.0);
    Se3 T;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto edge = std::find_if(rig.graph.edges.begin(), rig.graph.edges.end(),
                                     [&](const GraphEdge& e) { return e.id == cycle.edges[k]; });
      T = T * (edge->frame_a == cycle.sensors[k] ? edge->T_a_b : edge->T_a_b.Inverse());
    }
    EXPECT_LT((T.Log() - cycle.e).norm(), 1e-12);
  }
}

// A loop alone: its statistic is the cost of the solution, as nothing else is to be explained.
TEST(Cycles, StatisticOfALoneLoopIsTheCost) {
  RandomRig rig = FullRig(3, 16);
  std::swap(rig.graph.edges[1].frame_a, rig.graph.edges[1].frame_b);
  rig.graph.edges[1].Omega = InverseInformation(rig.graph.edges[1].T_a_b, rig.graph.edges[1].Omega);
  rig.graph.edges[1].T_a_b = rig.graph.edges[1].T_a_b.Inverse();
  const auto cycles = FindCycles(rig.graph);
  ASSERT_EQ(cycles.size(), 1u);
  EXPECT_NEAR(cycles[0].statistic, Solve(rig.graph).cost, 0.02 * cycles[0].statistic);
  EXPECT_TRUE(FindCycles(Graph()).empty());
  EXPECT_TRUE(FindCycles(MakeRig(3, 2, 17).graph).empty());
}

TEST(Cycles, TheSamePairTwiceIsALoop) {
  RandomRig rig = MakeRig(2, 1, 18);
  GraphEdge again = rig.graph.edges[0];
  again.id = IdOf(5);
  rig.graph.edges.push_back(again);
  const auto cycles = FindCycles(rig.graph);
  ASSERT_EQ(cycles.size(), 1u);
  EXPECT_LT(cycles[0].e.norm(), 1e-12);
  EXPECT_THAT(cycles[0].sensors, testing::SizeIs(2));
}

}  // namespace
}  // namespace rigcal::graph
