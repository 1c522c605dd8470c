// The server's live state against batch solutions of what the store holds.
#include "server/graph/solve/solve.h"
#include "server/pipeline/revisions/live_graphs.h"
#include "tests/unit/pipeline/fixture.h"

namespace rigcal::pipeline {
namespace {

void ExpectOptimum(const RobotGraph& loaded, const LiveGraph& live) {
  const GraphSolution batch = graph::Solve(loaded.graph), snapshot = live.solver->Snapshot();
  ASSERT_EQ(snapshot.poses.size(), batch.poses.size());
  EXPECT_NEAR(snapshot.cost, batch.cost, 1e-9 * batch.cost);
  EXPECT_NEAR(snapshot.after.total, batch.after.total, 1e-6 * batch.after.total);
  EXPECT_NEAR(snapshot.before.total, batch.before.total, 1e-9 * batch.before.total);
  EXPECT_EQ(snapshot.dof, batch.dof);
  for (std::size_t s = 0; s < batch.poses.size(); ++s) {
    EXPECT_EQ(snapshot.poses[s].sensor, batch.poses[s].sensor);
    EXPECT_EQ(snapshot.poses[s].known, batch.poses[s].known);
    EXPECT_LT((snapshot.poses[s].T_ref_sensor.p_m - batch.poses[s].T_ref_sensor.p_m).norm(), 1e-9);
  }
}

// Sensors in a ring with chords: every edge but a few closes a loop.
std::vector<Edge> Ring(int count) {
  std::vector<Edge> edges;
  for (int k = 0; k < count; ++k) {
    for (const int step : {1, 2, 5}) {
      const int other = (k + step) % count;
      edges.push_back(GivenEdge("r", std::to_string(k), std::to_string(other), other - k + 0.001 * (k % 7)));
    }
  }
  AssignPushedIds(edges);
  return edges;
}

class PipelineLiveTest : public PipelineTest {
 protected:
  RobotGraph Loaded() {
    auto loaded = LoadRobotGraph(*store_, RobotId("r"));
    if (!loaded) ADD_FAILURE() << Sentence(loaded.error());
    return loaded.value_or(RobotGraph());
  }
};

TEST_F(PipelineLiveTest, EdgesThatArriveOneByOneAreTakenInOneByOne) {
  LiveGraph live;
  const graph::LiveSolver* first = nullptr;
  for (const Edge& edge : Ring(12)) {
    StoreEdges({edge});
    const RobotGraph loaded = Loaded();
    TakeNewEdges(loaded, live);
    if (first == nullptr) first = live.solver.get();
    EXPECT_EQ(live.solver.get(), first);  // never started anew
    EXPECT_EQ(live.solver->graph().edges.size(), loaded.graph.edges.size());
    ExpectOptimum(loaded, live);
  }
}

TEST_F(PipelineLiveTest, ARestartFindsTheSameStateInTheStore) {
  LiveGraph live, restarted;
  for (const Edge& edge : Ring(10)) {
    StoreEdges({edge});
    TakeNewEdges(Loaded(), live);
  }
  TakeNewEdges(Loaded(), restarted);
  ExpectOptimum(Loaded(), restarted);
  EXPECT_NEAR(live.solver->Snapshot().cost, restarted.solver->Snapshot().cost, 1e-9 * live.solver->Snapshot().cost);
  EXPECT_EQ(live.watermark, restarted.watermark);
}

TEST_F(PipelineLiveTest, EdgesThatNoLongerCountAreTakenOut) {
  StoreEdges(Ring(10));
  RobotGraph loaded = Loaded();
  LiveGraph live;
  TakeNewEdges(loaded, live);
  loaded.graph.edges.erase(loaded.graph.edges.begin() + 3, loaded.graph.edges.begin() + 6);
  TakeNewEdges(loaded, live);
  EXPECT_EQ(live.solver->graph().edges.size(), 27u);
  ExpectOptimum(loaded, live);
}

TEST_F(PipelineLiveTest, AnotherReferenceMovesEveryPose) {
  StoreEdges(Ring(8));
  RobotGraph loaded = Loaded();
  LiveGraph live;
  TakeNewEdges(loaded, live);
  loaded.graph.reference = SensorId("3");
  TakeNewEdges(loaded, live);
  ExpectOptimum(loaded, live);
}

TEST_F(PipelineLiveTest, TheRevisionDoesNotDependOnTheLiveState) {
  std::vector<Edge> edges = Ring(9);
  for (const Edge& edge : edges) {
    StoreEdges({edge});
    ASSERT_TRUE(LoadRobotGraph(*store_, RobotId("r")));
    TakeNewEdges(Loaded(), live_.Of(RobotId("r")));
  }
  StepAll();
  ASSERT_EQ(revisions_.size(), 1u);
  auto other = storage::Store::Open(folder_ / "other");
  ASSERT_TRUE(other);
  std::swap(*store_, *other);
  std::reverse(edges.begin(), edges.end());
  StoreEdges(edges);
  LiveGraphs fresh;
  ASSERT_TRUE(Step({*store_, clock_, fresh, claims_, announcer_, cameras_}));
  ASSERT_EQ(revisions_.size(), 2u);
  EXPECT_EQ(revisions_[0].document, revisions_[1].document);
}

}  // namespace
}  // namespace rigcal::pipeline
