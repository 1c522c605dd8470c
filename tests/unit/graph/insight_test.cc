#include "server/graph/insight/insight.h"

#include <gmock/gmock.h>

#include <set>

#include "server/math/jackknife.h"
#include "server/math/statistics.h"
#include "tests/unit/graph/fixture.h"

namespace rigcal::graph {
namespace {

CycleOptions All() {
  CycleOptions options;
  options.worst_max = 100000;
  return options;
}

// Composed anew from the edges' measurements.
Se3 Compose(const Graph& graph, const CycleResidual& cycle) {
  Se3 T;
  for (std::size_t k = 0; k < cycle.edges.size(); ++k) {
    const GraphEdge& edge = EdgeBy(graph, cycle.edges[k]);
    T = T * (edge.frame_a == cycle.sensors[k] ? edge.T_a_b : edge.T_a_b.Inverse());
  }
  return T;
}

TEST(Cycles, LoopsAndTriangles) {
  const RandomRig rig = FullRig(4, 15);  // 3 fundamental loops, which are triangles with vertex 0; 1 more triangle
  const Cycles cycles = JudgeCycles(rig.graph, {});
  EXPECT_TRUE(cycles.judged);
  EXPECT_TRUE(cycles.why_not.empty());
  EXPECT_EQ(cycles.examined, 4);
  EXPECT_EQ(cycles.tested, 4);
  EXPECT_EQ(cycles.failing, 0);
  ASSERT_EQ(cycles.worst.size(), 4u);
  for (const CycleResidual& cycle : cycles.worst) {
    ASSERT_EQ(cycle.edges.size(), 3u);
    EXPECT_TRUE(cycle.tested);
    EXPECT_EQ(cycle.dof, 0.0);
    EXPECT_LT(cycle.t_squared, 30.0);
    EXPECT_NEAR(cycle.limit, 25.73, 0.01);  // chi-square of 6 at 1 - 0.001 / 4, by tables
    EXPECT_LT((Compose(rig.graph, cycle).Log() - cycle.e).norm(), 1e-12);
  }
}

// A loop alone: its statistic is the cost of the solution, as nothing else is to be explained.
TEST(Cycles, StatisticOfALoneLoopIsTheCost) {
  RandomRig rig = FullRig(3, 16);
  std::swap(rig.graph.edges[1].frame_a, rig.graph.edges[1].frame_b);
  rig.graph.edges[1].Omega = InverseInformation(rig.graph.edges[1].T_a_b, rig.graph.edges[1].Omega);
  rig.graph.edges[1].T_a_b = rig.graph.edges[1].T_a_b.Inverse();
  const Cycles cycles = JudgeCycles(rig.graph, {});
  ASSERT_EQ(cycles.worst.size(), 1u);
  EXPECT_NEAR(cycles.worst[0].t_squared, Solve(rig.graph).cost, 0.02 * cycles.worst[0].t_squared);
  EXPECT_TRUE(JudgeCycles(Graph(), {}).worst.empty());
  EXPECT_TRUE(JudgeCycles(MakeRig(3, 2, 17).graph, {}).worst.empty());
}

TEST(Cycles, TheSamePairTwiceIsALoop) {
  RandomRig rig = MakeRig(2, 1, 18);
  GraphEdge again = rig.graph.edges[0];
  again.id = IdOf(5);
  rig.graph.edges.push_back(again);
  const Cycles cycles = JudgeCycles(rig.graph, {});
  ASSERT_EQ(cycles.worst.size(), 1u);
  EXPECT_LT(cycles.worst[0].e.norm(), 1e-12);
  EXPECT_THAT(cycles.worst[0].sensors, testing::SizeIs(2));
}

void LeaveOpen(int first, int count, GraphEdge& edge) {
  edge.Omega.middleRows(first, count).setZero();
  edge.Omega.middleCols(first, count).setZero();
  edge.rank -= count;
}

// Motion on a floor measures no height: a metre of that is no contradiction, 0.1 m to the side is one.
TEST(Cycles, ALoopIsTestedInWhatAllItsEdgesMeasure) {
  RandomRig rig = FullRig(3, 19);
  GraphEdge& planar = rig.graph.edges[0];
  LeaveOpen(tangent::kZ, 1, planar);
  const Se3 measured = planar.T_a_b;
  for (const double height_m : {0.0, 1.0}) {
    planar.T_a_b = measured * Se3::Exp(height_m * Vector6d::Unit(tangent::kZ));
    const Cycles cycles = JudgeCycles(rig.graph, {});
    ASSERT_EQ(cycles.worst.size(), 1u);
    EXPECT_TRUE(cycles.worst[0].tested);
    EXPECT_EQ(cycles.worst[0].rank, 5);
    EXPECT_FALSE(cycles.worst[0].fails());
    EXPECT_LT(cycles.worst[0].e.head<3>().norm(), 0.05);
  }
  planar.T_a_b = measured * Se3::Exp(0.1 * Vector6d::Unit(tangent::kX));
  EXPECT_EQ(JudgeCycles(rig.graph, {}).failing, 1);
}

// What two level motions leave open should be one axis, and is two by their noise.
TEST(Cycles, AxesThatNoiseTiltsHideNothingAcrossThem) {
  RandomRig rig = FullRig(3, 19);
  for (GraphEdge& edge : rig.graph.edges) {
    edge.T_a_b = Se3();
    edge.Omega = 1e6 * Matrix6d::Identity();
  }
  for (const int k : {0, 1}) {
    GraphEdge& planar = rig.graph.edges[static_cast<std::size_t>(k)];
    const double tilt_rad = k == 0 ? 5e-4 : -5e-4;
    const Vector6d open = (Vector6d() << std::sin(tilt_rad), 0, std::cos(tilt_rad), 0, 0, 0).finished();
    planar.Omega = 1e6 * (Matrix6d::Identity() - open * open.transpose());
    planar.rank = 5;
  }
  const auto off = [&](int axis, double by_m) {
    rig.graph.edges[2].T_a_b = Se3::Exp(by_m * Vector6d::Unit(axis));
    return JudgeCycles(rig.graph, {}).worst.at(0);
  };
  EXPECT_TRUE(off(tangent::kX, 0.03).fails()) << "30 mm where both measure one";
  EXPECT_NEAR(off(tangent::kX, 0.03).e.head<3>().norm(), 0.03, 0.003);
  EXPECT_EQ(off(tangent::kX, 0.03).rank, 5);
  EXPECT_FALSE(off(tangent::kX, 0.002).fails());
  EXPECT_FALSE(off(tangent::kZ, 0.5).fails()) << "the height is nobody's measurement";
}

// One sees where, one how it is turned: together they measure nothing of the loop.
TEST(Cycles, EdgesThatLeaveAllOpenBetweenThemGiveNoTest) {
  RandomRig rig = FullRig(3, 19);
  LeaveOpen(0, 3, rig.graph.edges[0]);
  LeaveOpen(3, 3, rig.graph.edges[1]);
  const Cycles cycles = JudgeCycles(rig.graph, {});
  ASSERT_EQ(cycles.worst.size(), 1u);
  EXPECT_FALSE(cycles.worst[0].tested);
  EXPECT_EQ(cycles.worst[0].limit, 0.0);
  EXPECT_FALSE(cycles.worst[0].fails());
  EXPECT_EQ(cycles.tested, 0);
}

TEST(Cycles, EveryFailingLoopHoldsTheWrongEdge) {
  RandomRig rig = FullRig(6, 20);
  GraphEdge& wrong = rig.graph.edges[7];
  wrong.T_a_b = wrong.T_a_b * Se3::Exp(0.1 * Vector6d::Ones());
  const Cycles cycles = JudgeCycles(rig.graph, {}, All());
  EXPECT_EQ(cycles.failing, 4);  // triangles of an edge of a complete graph of 6
  for (const CycleResidual& cycle : cycles.worst)
    EXPECT_EQ(cycle.fails(), testing::Value(cycle.edges, testing::Contains(wrong.id)));
  for (int k = 0; k < 4; ++k) EXPECT_TRUE(cycles.worst[static_cast<std::size_t>(k)].fails());
}

// Many fail by a hair, one by much: it is not among the worst by its test alone.
TEST(Cycles, TheMostOpenOfThoseThatFailIsKept) {
  RandomRig rig = FullRig(8, 19);
  for (GraphEdge& edge : rig.graph.edges) edge.Omega *= 1e6;  // sigmas a thousand times too small: all loops fail
  GraphEdge& weak = rig.graph.edges.back();
  weak.Omega /= 1e6;
  weak.T_a_b = weak.T_a_b * Se3::Exp(0.5 * Vector6d::Unit(tangent::kX));
  const Cycles all = JudgeCycles(rig.graph, {}, All());
  CycleOptions few;
  few.worst_max = 5;
  const Cycles judged = JudgeCycles(rig.graph, {}, few);
  ASSERT_GT(judged.failing, 30);
  ASSERT_EQ(judged.worst.size(), 5u);
  const auto openness = [](const CycleResidual& cycle) { return cycle.e.head<3>().norm(); };
  double most_m = 0.0;
  for (const CycleResidual& cycle : all.worst) most_m = std::max(most_m, openness(cycle));
  EXPECT_EQ(openness(judged.worst.back()), most_m);
  EXPECT_LT(openness(all.worst[4]), 0.5 * most_m) << "it would have been left out";
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(judged.worst[k].edges, all.worst[k].edges);
}

// Four sure edges and a rough one across: by fewest hops both loops would go over that one.
TEST(Cycles, SureEdgesCloseLoopsOfTheirOwn) {
  RandomRig rig = FullRig(4, 26);  // 01 02 03 12 13 23
  std::vector<GraphEdge>& edges = rig.graph.edges;
  edges.erase(edges.begin() + 4);
  for (GraphEdge& edge : edges) edge.Omega = 1e6 * Matrix6d::Identity();
  edges[1].Omega = 400.0 * Matrix6d::Identity();  // 02, 50 mm
  const Cycles cycles = JudgeCycles(rig.graph, {});
  ASSERT_EQ(cycles.worst.size(), 3u);
  const auto over_rough = [&](const CycleResidual& cycle) {
    return std::find(cycle.edges.begin(), cycle.edges.end(), edges[1].id) != cycle.edges.end();
  };
  EXPECT_EQ(std::count_if(cycles.worst.begin(), cycles.worst.end(), over_rough), 2);
}

TEST(Cycles, WhatIsNotAmongTheWorstIsGivenBackBeside) {
  CycleOptions few;
  few.worst_max = 3;
  const Cycles cycles = JudgeCycles(FullRig(6, 20).graph, {}, few);
  EXPECT_EQ(cycles.worst.size(), 3u);
  EXPECT_EQ(static_cast<std::int64_t>(cycles.others.size()), cycles.tested - 3);
  EXPECT_EQ(cycles.Loops().size(), cycles.worst.size() + cycles.others.size());
}

TEST(Cycles, OrderOfEdgesDoesNotMatter) {
  const RandomRig rig = MakeRig(8, 20, 21);
  Graph shuffled = rig.graph;
  std::reverse(shuffled.edges.begin(), shuffled.edges.end());
  const Cycles a = JudgeCycles(rig.graph, {}), b = JudgeCycles(shuffled, {});
  ASSERT_EQ(a.worst.size(), b.worst.size());
  for (std::size_t k = 0; k < a.worst.size(); ++k) {
    EXPECT_EQ(a.worst[k].edges, b.worst[k].edges);
    EXPECT_EQ(a.worst[k].e, b.worst[k].e);
    EXPECT_EQ(a.worst[k].t_squared, b.worst[k].t_squared);
  }
}

TEST(Cycles, LargeGraphsStopAtTheLimitAndSaySo) {
  CycleOptions options = All();
  options.steps_max = 40;
  const RandomRig rig = FullRig(8, 22);
  const Cycles cycles = JudgeCycles(rig.graph, {}, options);
  EXPECT_TRUE(cycles.judged);
  EXPECT_EQ(cycles.examined, 13);  // of three steps each
  EXPECT_THAT(cycles.why_not, testing::HasSubstr("the first 13 were worked out"));
}

// Three cameras in one session: a capture errs alike in all edges of a camera.
struct SharedSession {
  RandomRig rig;
  BlocksByEdge blocks;
};

SharedSession MakeSharedSession(int m, unsigned seed) {
  SharedSession made;
  made.rig = FullRig(3, 23);
  std::mt19937 random(seed);
  std::vector<std::vector<Vector6d>> of_camera(3);
  for (auto& errors : of_camera)
    for (int i = 0; i < m; ++i) errors.push_back(RandomVector(random, 0.005, 0.005));
  for (GraphEdge& edge : made.rig.graph.edges) {
    const auto a = std::stoul(edge.frame_a.str()), b = std::stoul(edge.frame_b.str());
    const Se3 truth = made.rig.truth[a].Inverse() * made.rig.truth[b];
    std::vector<Vector6d> errors, d;
    Vector6d mean = Vector6d::Zero();
    for (std::size_t i = 0; i < static_cast<std::size_t>(m); ++i) {
      errors.push_back(of_camera[b][i] - Adjoint(truth.Inverse()) * of_camera[a][i] +
                       RandomVector(random, 0.001, 0.001));
      mean += errors.back() / m;
    }
    for (int i = 0; i < m; ++i) {
      d.push_back(-(errors[static_cast<std::size_t>(i)] - mean) / (m - 1));
      made.blocks[edge.id].blocks.push_back({std::to_string(100 + i), d.back()});
    }
    made.blocks[edge.id].dof = edge.dof = m - 1;
    edge.session = SessionId(std::string(64, 'a'));
    edge.T_a_b = (truth * Se3::Exp(mean)).Normalized();
    edge.Omega = Symmetrized(JackknifeCovariance(d).inverse());
  }
  return made;
}

// Against the loop composed anew without each block: no derivative, no tangent of ours.
TEST(Cycles, SharedCapturesAreLeftOutOfTheWholeLoop) {
  const SharedSession made = MakeSharedSession(30, 24);
  const Cycles cycles = JudgeCycles(made.rig.graph, made.blocks);
  ASSERT_EQ(cycles.worst.size(), 1u);
  const CycleResidual& cycle = cycles.worst[0];
  std::vector<Vector6d> d;
  for (std::size_t i = 0; i < 30; ++i) {
    Graph without = made.rig.graph;
    for (GraphEdge& edge : without.edges) edge.T_a_b = edge.T_a_b * Se3::Exp(made.blocks.at(edge.id).blocks[i].d);
    d.push_back((Compose(made.rig.graph, cycle).Inverse() * Compose(without, cycle)).Log());
  }
  const double expected = cycle.e.dot(JackknifeCovariance(d).ldlt().solve(cycle.e));
  EXPECT_NEAR(cycle.t_squared, expected, 0.02 * expected);
  EXPECT_EQ(cycle.rank, 6);
  EXPECT_NEAR(cycle.dof, 29.0, 1e-9);
  EXPECT_NEAR(cycle.limit, HotellingLimit(30, 6, 0.999), 1e-9);
  const Cycles apart = JudgeCycles(made.rig.graph, {});  // as independent, the loop seems far better than it may be
  EXPECT_LT(apart.worst[0].t_squared, 0.2 * cycle.t_squared);
}

// 600 sessions at odds of 0.001 each: more than 8 false alarms have odds below 1e-6.
TEST(Cycles, AGoodSessionSeldomFails) {
  int failing = 0;
  for (unsigned seed = 0; seed < 600; ++seed) {
    const SharedSession made = MakeSharedSession(13, 1000 + seed);
    failing += JudgeCycles(made.rig.graph, made.blocks).failing > 0 ? 1 : 0;
  }
  EXPECT_LE(failing, 8);
}

}  // namespace
}  // namespace rigcal::graph
