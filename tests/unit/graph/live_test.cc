// The live state: every change ends at the batch optimum of the edges that are left.
#include <gtest/gtest.h>

#include "server/graph/live/live_solver.h"
#include "tests/unit/graph/fixture.h"

namespace rigcal::graph {
namespace {

// At the far end of a long chain poses move by micrometres at no cost to speak of.
void ExpectOptimum(const LiveSolver& live, double distance_max = 1e-6) {
  const GraphSolution batch = Solve(live.graph());
  EXPECT_NEAR(live.Snapshot().cost, batch.cost, 1e-9 * std::max(batch.cost, 1e-3));
  for (const SensorPose& pose : batch.poses) {
    const std::optional<Se3> T = live.PoseOf(pose.sensor);
    ASSERT_EQ(T.has_value(), pose.known) << pose.sensor.str();
    if (!T) continue;
    EXPECT_LT(Distance(*T, pose.T_ref_sensor), distance_max) << pose.sensor.str();
  }
}

LiveSolver Fed(const Graph& graph) {
  LiveSolver live(graph.reference);
  for (const GraphEdge& edge : graph.edges) live.Add(edge);
  return live;
}

TEST(GraphLive, ALargeWellConnectedGraphStaysAtTheOptimum) {
  const RandomRig rig = MakeRig(90, 400, 70);
  LiveSolver live(rig.graph.reference);
  for (std::size_t k = 0; k < rig.graph.edges.size(); ++k) {
    live.Add(rig.graph.edges[k]);
    if (k % 40 == 39 || k + 1 == rig.graph.edges.size()) ExpectOptimum(live);
  }
}

TEST(GraphLive, ADeepGraphStaysAtTheOptimum) {
  RandomRig rig = MakeRig(60, 60, 71);
  rig.graph.edges.clear();
  std::mt19937 random(72);
  const Matrix6d Omega = 1e4 * Matrix6d::Identity();
  const auto add = [&](std::size_t a, std::size_t b) {
    const Se3 T_a_b = rig.truth[a].Inverse() * rig.truth[b] * Se3::Exp(RandomVector(random, 0.01, 0.01));
    rig.graph.edges.push_back(MakeEdge(rig.graph.edges.size(), a, b, T_a_b.Normalized(), Omega));
  };
  for (std::size_t v = 1; v < 60; ++v) add(v - 1, v);
  for (std::size_t v = 10; v < 60; v += 10) add(v - 10, v);
  ExpectOptimum(Fed(rig.graph));
}

TEST(GraphLive, PartsThatMeetLaterAreJoined) {
  RandomRig rig = MakeRig(12, 40, 74);
  std::reverse(rig.graph.edges.begin(), rig.graph.edges.end());
  LiveSolver live(rig.graph.reference);
  for (const GraphEdge& edge : rig.graph.edges) {
    live.Add(edge);
    ExpectOptimum(live);
  }
}

TEST(GraphLive, AGrossErrorIsFollowedToo) {
  RandomRig rig = MakeRig(8, 25, 75);
  Vector6d turn = Vector6d::Zero();
  turn(tangent::kRz) = 2.0;
  rig.graph.edges[20].T_a_b = rig.graph.edges[20].T_a_b * Se3::Exp(turn);
  LiveSolver live = Fed(rig.graph);
  ExpectOptimum(live);
  EXPECT_TRUE(live.Remove(rig.graph.edges[20].id).batch);  // the others may want another basin
  ExpectOptimum(live);
}

TEST(GraphLive, DeficientUnusableAndSelfEdgesBehave) {
  const RandomRig rig = MakeRig(6, 12, 76);
  LiveSolver live = Fed(rig.graph);
  GraphEdge edge = rig.graph.edges[0];
  edge.id = IdOf(100);
  edge.Omega(2, 2) = -1.0;
  live.Add(edge);
  ExpectOptimum(live);
  edge = rig.graph.edges[1];
  edge.id = IdOf(101);
  edge.frame_b = edge.frame_a;
  live.Add(edge);
  ExpectOptimum(live);
  edge = rig.graph.edges[2];
  edge.id = IdOf(102);
  edge.Omega.row(0).setZero();
  edge.Omega.col(0).setZero();
  edge.rank = 5;
  EXPECT_TRUE(live.Add(edge).batch);
  ExpectOptimum(live);
  edge = rig.graph.edges[3];
  edge.id = IdOf(103);
  edge.frame_b = SensorId("new");
  live.Add(edge);
  ExpectOptimum(live);
  EXPECT_FALSE(live.Snapshot().poses.empty());
}

TEST(GraphLive, AnEmptyStateAnswers) {
  const LiveSolver live{SensorId("a")};
  EXPECT_EQ(live.Snapshot().cost, 0.0);
  EXPECT_FALSE(live.PoseOf(SensorId("a")).has_value());
  LiveSolver lonely{SensorId("a")};
  lonely.AddSensor(SensorId("a"));
  EXPECT_TRUE(lonely.PoseOf(SensorId("a")).has_value());
  lonely.AddSensor(SensorId("b"));
  EXPECT_FALSE(lonely.PoseOf(SensorId("b")).has_value());
}

TEST(GraphLive, MarginalsAreThoseOfTheBatch) {
  const RandomRig rig = MakeRig(12, 59, 77);
  const LiveSolver live = Fed(rig.graph);
  const GraphSolution batch = Solve(rig.graph);
  const auto marginals = live.Marginals();
  ASSERT_EQ(marginals.size(), 12U);
  for (const auto& [sensor, covariance] : marginals) {
    const Matrix6d& expected = batch.poses[std::stoul(sensor.str())].covariance;
    EXPECT_LE((covariance - expected).norm(), 1e-6 * expected.norm()) << sensor.str();
  }
}

// A cylinder: a long chain, closed to the row before at every vertex; deep, and larger than what is kept exact.
Graph Cylinder(std::size_t count, std::size_t around, unsigned seed, std::vector<Se3>& truth, double step_m = 0.3,
               double sigma = 0.01) {
  std::mt19937 random(seed);
  Graph graph;
  truth.assign(1, Se3());
  for (std::size_t v = 1; v < count; ++v)
    truth.push_back((truth.back() * Se3::Exp(RandomVector(random, step_m, 0.1))).Normalized());
  const Matrix6d Omega = Matrix6d::Identity() / (sigma * sigma);
  const auto add = [&](std::size_t a, std::size_t b) {
    const Se3 T_a_b = truth[a].Inverse() * truth[b] * Se3::Exp(RandomVector(random, sigma, sigma));
    graph.edges.push_back(MakeEdge(graph.edges.size(), a, b, T_a_b.Normalized(), Omega));
  };
  for (std::size_t v = 1; v < count; ++v) {
    add(v - 1, v);
    if (v >= around) add(v - around, v);
  }
  for (std::size_t v = 0; v < count; ++v) graph.sensors.push_back(Name(v));
  graph.reference = Name(0);
  return graph;
}

// Small, shallow and deep graphs, and such as are larger than what is kept exact.
std::vector<Graph> GraphsOfEveryKind() {
  std::vector<Se3> truth;
  return {MakeRig(10, 30, 73).graph, MakeRig(90, 400, 86).graph, MakeRig(260, 1000, 87, 0.005, 0.005, false).graph,
          Cylinder(120, 10, 88, truth), Cylinder(320, 12, 89, truth)};
}

// At the optimum, or as near as a large graph's budget says; settled, at the optimum.
void ExpectOptimumOfKind(LiveSolver& live) {
  if (live.graph().sensors.size() <= 200) return ExpectOptimum(live, 1e-5);
  EXPECT_LE(live.Snapshot().cost, (1.0 + 1e-3) * Solve(live.graph()).cost);
}

TEST(GraphLive, RemovedEdgesCount) {
  for (const Graph& graph : GraphsOfEveryKind()) {
    LiveSolver live(graph);
    const double batch = live.Settle().products;
    double products = 0.0;
    const std::size_t first = graph.edges.size() / 5, stride = graph.edges.size() / 6;
    for (std::size_t k = first; k < graph.edges.size(); k += stride) {
      const UpdateWork removed = live.Remove(graph.edges[k].id);
      EXPECT_FALSE(removed.batch) << graph.edges.size() << ' ' << k;
      EXPECT_LT(removed.products, batch) << graph.edges.size() << ' ' << k;
      products += removed.products;
      ExpectOptimumOfKind(live);
      if (k % 2 == 0) live.Add(graph.edges[k]);
      ExpectOptimumOfKind(live);
    }
    EXPECT_GT(products, 0.0);
    live.Settle();
    ExpectOptimum(live);
  }
}

TEST(GraphLive, RemovingWhatIsNotThereDoesNothing) {
  const RandomRig rig = MakeRig(10, 30, 73);
  LiveSolver live = Fed(rig.graph);
  const double cost = live.Snapshot().cost;
  EXPECT_EQ(live.Remove(IdOf(999)).iterations, 0);
  EXPECT_EQ(live.Snapshot().cost, cost);
  EXPECT_EQ(live.graph().edges.size(), 30U);
}

// What falls off without an edge, comes again with it.
TEST(GraphLive, RemovingABridgeLosesWhatHangsOnIt) {
  std::vector<Se3> truth;
  for (Graph graph : {MakeRig(10, 30, 90).graph, Cylinder(80, 10, 91, truth)}) {
    const std::size_t count = graph.edges.size();
    const SensorId last = graph.edges.back().frame_b;
    const auto hang = [&graph](const SensorId& a, const SensorId& b) {
      GraphEdge edge = graph.edges[0];
      edge.id = IdOf(graph.edges.size());
      edge.frame_a = a, edge.frame_b = b;
      graph.edges.push_back(edge);
    };
    hang(last, SensorId("tail"));
    hang(SensorId("tip"), SensorId("tail"));
    LiveSolver live = Fed(graph);
    const Se3 T_ref_tip = live.PoseOf(SensorId("tip")).value();
    EXPECT_TRUE(live.Remove(graph.edges[count].id).batch);
    EXPECT_FALSE(live.PoseOf(SensorId("tip")).has_value());
    ExpectOptimum(live);
    EXPECT_EQ(live.Remove(graph.edges[count + 1].id).iterations, 0);  // it took no part
    live.Add(graph.edges[count]);
    live.Add(graph.edges[count + 1]);
    EXPECT_LT(Distance(T_ref_tip, live.PoseOf(SensorId("tip")).value()), 1e-6);
    ExpectOptimum(live);
  }
}

// Edges come and go in a deep graph, also those that tied a sensor to earlier ones; parts hang, join, hang again.
TEST(GraphLive, EdgesComeAndGoInAnyOrder) {
  std::vector<Se3> truth;
  for (unsigned seed = 92; seed < 96; ++seed) {
    const Graph graph = Cylinder(70, 6, seed, truth);
    LiveSolver live = Fed(graph);
    std::mt19937 random(seed);
    std::vector<bool> present(graph.edges.size(), true);
    int batches = 0;
    for (int step = 0; step < 120; ++step) {
      const std::size_t k = random() % graph.edges.size();
      const UpdateWork work = present[k] ? live.Remove(graph.edges[k].id) : live.Add(graph.edges[k]);
      present[k] = !present[k];
      batches += work.batch ? 1 : 0;
      ExpectOptimum(live, 1e-5);
    }
    EXPECT_LT(batches, 60);
  }
}

TEST(GraphLive, AnEdgeThatCannotBeUsedMakesNoUpdateABatch) {
  RandomRig rig = MakeRig(10, 30, 97);
  const GraphEdge last = rig.graph.edges.back();
  rig.graph.edges.back().Omega *= -1.0;
  LiveSolver live(rig.graph);
  EXPECT_EQ(Solve(live.graph()).diagnoses.size(), 1U);
  GraphEdge mended = last;
  mended.id = IdOf(100);
  EXPECT_FALSE(live.Add(mended).batch);
  EXPECT_EQ(live.Remove(last.id).iterations, 0);
  ExpectOptimum(live);
  EXPECT_TRUE(Solve(live.graph()).diagnoses.empty());
  EXPECT_FALSE(live.Remove(rig.graph.edges[20].id).batch);
  ExpectOptimum(live);
}

TEST(GraphLive, ALargeDeepGraphKeepsToItsBudgetAndSettles) {
  std::vector<Se3> truth;
  const Graph graph = Cylinder(320, 12, 78, truth);
  LiveSolver live(graph.reference);
  int stopped_short = 0;
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    const UpdateWork work = live.Add(graph.edges[k]);
    EXPECT_LE(work.products, 4e6);
    EXPECT_LE(work.rest_ratio, 3e-4);
    EXPECT_TRUE(work.rest_ratio <= 1e-9 || !live.settled());
    stopped_short += live.settled() ? 0 : 1;
    if (k % 30 != 0) continue;
    const double optimum = Solve(live.graph()).cost;
    const bool exact = live.graph().sensors.size() <= 200;
    EXPECT_LE(live.Snapshot().cost, (1.0 + (exact ? 1e-9 : 1e-3)) * optimum + 1e-12) << k;
  }
  EXPECT_GT(stopped_short, 0);
  live.Settle();
  EXPECT_TRUE(live.settled());
  ExpectOptimum(live);
}

// Long chains hang on the part that is solved, and are taken into it from either end.
TEST(GraphLive, ChainsThatHangFollowAndJoinLater) {
  std::vector<Se3> truth;
  Graph graph = Cylinder(150, 15, 81, truth);
  std::stable_partition(graph.edges.begin(), graph.edges.end(), [](const GraphEdge& edge) {
    return std::stoi(edge.frame_b.str()) - std::stoi(edge.frame_a.str()) == 1;
  });
  std::reverse(graph.edges.begin() + 149 + 60, graph.edges.end());
  for (std::size_t k = 0; k < 149; k += 3) {  // some chain edges point back
    GraphEdge& edge = graph.edges[k];
    std::swap(edge.frame_a, edge.frame_b);
    edge.T_a_b = edge.T_a_b.Inverse();
  }
  LiveSolver live(graph.reference);
  int batches = 0;
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    batches += live.Add(graph.edges[k]).batch ? 1 : 0;
    if (k < 170 || k % 12 == 0 || k + 1 == graph.edges.size()) ExpectOptimum(live, 1e-5);
  }
  EXPECT_LT(batches, 30);
}

TEST(GraphLive, WorkIsCounted) {
  std::vector<Se3> truth;
  for (const Graph& graph : {MakeRig(10, 30, 83).graph, MakeRig(90, 300, 84).graph, Cylinder(80, 10, 85, truth)}) {
    LiveSolver live(graph.reference);
    for (const GraphEdge& edge : graph.edges) {
      const UpdateWork work = live.Add(edge);
      EXPECT_EQ(work.products > 0.0, work.iterations > 0 || work.columns_factored > 0);
    }
    EXPECT_GT(live.Settle().products, 0.0);
  }
}

TEST(GraphLive, TheSameEdgesGiveTheSamePosesAndTheSameWork) {
  std::vector<Se3> truth;
  const Graph graph = Cylinder(260, 10, 79, truth);
  LiveSolver first(graph.reference), second(graph.reference);
  for (const GraphEdge& edge : graph.edges) {
    const std::vector<char> odd(static_cast<std::size_t>(first.graph().edges.size() % 37 + 1));
    const UpdateWork work = first.Add(edge), again = second.Add(edge);
    EXPECT_EQ(work.products, again.products);
    EXPECT_EQ(work.rest_ratio, again.rest_ratio);
    EXPECT_FALSE(odd.empty());
  }
  EXPECT_EQ(first.Snapshot().cost, second.Snapshot().cost);
}

// Frames in one place are moved by their noise alone, which does not make their edges bent.
TEST(GraphLive, FramesInOnePlaceAreNoMoreWorkThanOthers) {
  const auto columns = [](double step_m) {
    std::vector<Se3> truth;
    const Graph graph = Cylinder(190, 12, 98, truth, step_m, 0.001);
    LiveSolver live(graph.reference);
    int sum = 0;
    for (const GraphEdge& edge : graph.edges) sum += live.Add(edge).columns_factored;
    ExpectOptimum(live);
    return sum;
  };
  EXPECT_LT(columns(0.0), 3 * columns(0.3) / 2);
}

// A part of sphere2500 in file order: the whole chain first, then closure by closure.
TEST(GraphLive, ASphereIsFollowedClosureByClosure) {
  constexpr const char* kFile = "posegraph_sesync/sphere2500.g2o";
  RIGCAL_SKIP_WITHOUT_RECORDING(kFile);
  Result<formats::G2oFile> file = ReadData(kFile);
  ASSERT_TRUE(file.has_value()) << Sentence(file.error());
  std::erase_if(file->edges, [](const Edge& edge) {
    return std::max(std::stoi(edge.frame_a.str()), std::stoi(edge.frame_b.str())) >= 500;
  });
  const Graph graph = GraphOf(file->edges, file->fixed);
  LiveSolver live(graph.reference);
  int batches = 0;
  for (std::size_t k = 0; k < graph.edges.size(); ++k) {
    const UpdateWork work = live.Add(graph.edges[k]);
    batches += work.batch ? 1 : 0;
    EXPECT_LE(work.rest_ratio, 3e-4) << k;
    if (k % 50 != 0) continue;
    EXPECT_LE(live.Snapshot().cost, (1.0 + 1e-3) * Solve(live.graph()).cost + 1e-12) << k;
  }
  EXPECT_EQ(batches, 0);
  live.Settle();
  const double optimum = Solve(graph).cost;
  EXPECT_NEAR(live.Snapshot().cost, optimum, 1e-9 * optimum);
}

TEST(GraphLive, ATinyBudgetStopsEarlyAndSettlingMakesUpForIt) {
  std::vector<Se3> truth;
  const Graph graph = Cylinder(260, 10, 80, truth);
  UpdateBudget budget;
  budget.sensors_exact_max = 60;
  budget.rest_ratio = 0.0;
  budget.products_max = 2e4;
  LiveSolver live(graph.reference, budget);
  for (const GraphEdge& edge : graph.edges) live.Add(edge);
  live.Settle();
  ExpectOptimum(live);
}

}  // namespace
}  // namespace rigcal::graph
