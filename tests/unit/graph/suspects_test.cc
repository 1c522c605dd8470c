#include <gmock/gmock.h>

#include "server/graph/insight/insight.h"
#include "tests/unit/graph/fixture.h"

namespace rigcal::graph {
namespace {

using testing::UnorderedElementsAre;

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

}  // namespace
}  // namespace rigcal::graph
