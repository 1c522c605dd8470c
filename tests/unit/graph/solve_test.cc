#include <gmock/gmock.h>

#include <cmath>

#include "tests/unit/graph/fixture.h"

namespace rigcal::graph {
namespace {

bool AllFinite(const GraphSolution& solution) {
  for (const SensorPose& pose : solution.poses)
    if (!pose.T_ref_sensor.p_m.allFinite() || !pose.T_ref_sensor.q.coeffs().allFinite() || !pose.covariance.allFinite())
      return false;
  for (const EdgeResidual& residual : solution.residuals)
    if (!residual.e.allFinite() || !std::isfinite(residual.weighted)) return false;
  return std::isfinite(solution.cost) && std::isfinite(solution.before.total) && std::isfinite(solution.after.total);
}

TEST(GraphSolve, ExactMeasurementsGiveTheTruth) {
  const RandomRig rig = MakeRig(8, 20, 1, 1e-13, 1e-13, false);
  const GraphSolution solution = Solve(rig.graph);
  ASSERT_TRUE(solution.converged);
  for (std::size_t v = 0; v < 8; ++v) EXPECT_LT(Distance(solution.poses[v].T_ref_sensor, rig.truth[v]), 1e-11) << v;
}

TEST(GraphSolve, NoiseIsAveragedDown) {
  const RandomRig rig = MakeRig(12, 59, 2);
  const GraphSolution solution = Solve(rig.graph);
  ASSERT_TRUE(solution.converged);
  EXPECT_EQ(solution.dof, 6 * (59 - 11));
  EXPECT_GT(solution.cost, 0.6 * solution.dof);
  EXPECT_LT(solution.cost, 1.4 * solution.dof);
  for (std::size_t v = 0; v < 12; ++v) EXPECT_LT(Distance(solution.poses[v].T_ref_sensor, rig.truth[v]), 0.02) << v;
}

TEST(GraphSolve, ReferenceHasTheIdentityAndNoUncertainty) {
  RandomRig rig = MakeRig(6, 12, 3);
  rig.graph.reference = Name(4);
  const GraphSolution solution = Solve(rig.graph);
  const SensorPose& reference = solution.poses[4];
  EXPECT_TRUE(reference.known);
  EXPECT_EQ(reference.T_ref_sensor.p_m, Eigen::Vector3d::Zero());
  EXPECT_EQ(reference.T_ref_sensor.q.w(), 1.0);
  EXPECT_EQ(reference.covariance, Matrix6d::Zero());
}

TEST(GraphSolve, EveryOrderOfEdgesAndSensorsGivesTheSameBytes) {
  for (const auto& [vertices, edges] : {std::pair<std::size_t, std::size_t>(12, 59), {70, 200}}) {
    RandomRig rig = MakeRig(vertices, edges, 4);
    const GraphSolution first = Solve(rig.graph);
    std::mt19937 random(5);
    for (int round = 0; round < 10; ++round) {
      std::shuffle(rig.graph.edges.begin(), rig.graph.edges.end(), random);
      EXPECT_TRUE(SameBytes(first, Solve(rig.graph))) << vertices << " sensors, round " << round;
    }
  }
}

TEST(GraphSolve, DirectionOfAnEdgeDoesNotMatter) {
  const RandomRig rig = MakeRig(10, 30, 6);
  Graph reversed = rig.graph;
  for (std::size_t k = 0; k < reversed.edges.size(); k += 2) {
    GraphEdge& edge = reversed.edges[k];
    edge.Omega = InverseInformation(edge.T_a_b, edge.Omega);
    edge.T_a_b = edge.T_a_b.Inverse();
    std::swap(edge.frame_a, edge.frame_b);
  }
  const GraphSolution a = Solve(rig.graph), b = Solve(reversed);
  EXPECT_NEAR(a.cost, b.cost, 1e-10 * a.cost);
  for (std::size_t v = 0; v < 10; ++v) EXPECT_LT(Distance(a.poses[v].T_ref_sensor, b.poses[v].T_ref_sensor), 1e-9) << v;
}

TEST(GraphSolve, AnotherReferenceGivesTheSameRelativePoses) {
  RandomRig rig = MakeRig(10, 30, 7);
  const GraphSolution a = Solve(rig.graph);
  rig.graph.reference = Name(6);
  const GraphSolution b = Solve(rig.graph);
  EXPECT_NEAR(a.cost, b.cost, 1e-10 * a.cost);
  for (std::size_t v = 0; v < 10; ++v) {
    const Se3 T_6_v = a.poses[6].T_ref_sensor.Inverse() * a.poses[v].T_ref_sensor;
    EXPECT_LT(Distance(T_6_v, b.poses[v].T_ref_sensor), 1e-9) << v;
  }
}

// Moving both frames of every edge rigidly (T_a_b -> X_a T_a_b X_b^-1 with one X per sensor) re-bases the whole rig.
TEST(GraphSolve, RebasedFramesGiveRebasedPoses) {
  const RandomRig rig = MakeRig(8, 20, 8);
  std::mt19937 random(9);
  std::vector<Se3> T_new_old;
  for (int v = 0; v < 8; ++v) T_new_old.push_back(Se3::Exp(RandomVector(random, 1.0, 1.0)));
  Graph rebased = rig.graph;
  for (GraphEdge& edge : rebased.edges) {
    const Se3 &X_a = T_new_old[std::stoul(edge.frame_a.str())], &X_b = T_new_old[std::stoul(edge.frame_b.str())];
    edge.T_a_b = X_a * edge.T_a_b * X_b.Inverse();
    const Matrix6d A = Adjoint(X_b.Inverse());
    edge.Omega = A.transpose() * edge.Omega * A;
  }
  const GraphSolution a = Solve(rig.graph), b = Solve(rebased);
  EXPECT_NEAR(a.cost, b.cost, 1e-9 * a.cost);
  for (std::size_t v = 0; v < 8; ++v) {
    const Se3 expected = T_new_old[0] * a.poses[v].T_ref_sensor * T_new_old[v].Inverse();
    EXPECT_LT(Distance(expected, b.poses[v].T_ref_sensor), 1e-8) << v;
  }
}

TEST(GraphSolve, BeforeIsMeasuredAtTheTreeOfTheMostCertainEdges) {
  // A triangle whose third edge is the least certain and is 30 mm off along y of sensor 2.
  Graph graph{Name(0), {Name(0), Name(1), Name(2)}, {}};
  const Matrix6d Omega = 1e6 * Matrix6d::Identity();
  Se3 T;
  T.p_m.x() = 1.0;
  graph.edges.push_back(MakeEdge(0, 0, 1, T, Omega));
  graph.edges.push_back(MakeEdge(1, 1, 2, T, Omega));
  T.p_m << 2.0, -0.03, 0.0;
  graph.edges.push_back(MakeEdge(2, 0, 2, T, 0.5 * Omega));
  const GraphSolution solution = Solve(graph);
  EXPECT_NEAR(solution.before.translation_m2, 0.03 * 0.03 / 3, 1e-15);
  EXPECT_NEAR(solution.before.rotation_rad2, 0.0, 1e-15);
  EXPECT_LT(solution.after.total, solution.before.total);
  double weakest_y = 0.0;
  for (const EdgeResidual& residual : solution.residuals)
    if (residual.edge == IdOf(2)) weakest_y = residual.e(tangent::kY);
  EXPECT_GT(weakest_y, 0.01);
}

TEST(GraphSolve, CostAndGlobalErrorAreSumsOfTheResiduals) {
  const RandomRig rig = MakeRig(7, 15, 10);
  const GraphSolution solution = Solve(rig.graph);
  double cost = 0.0, translation = 0.0, rotation = 0.0;
  for (const EdgeResidual& residual : solution.residuals) {
    const auto edge = std::find_if(rig.graph.edges.begin(), rig.graph.edges.end(),
                                   [&](const GraphEdge& e) { return e.id == residual.edge; });
    EXPECT_NEAR(residual.weighted, residual.e.dot(edge->Omega * residual.e), 1e-9 * residual.weighted);
    cost += residual.weighted;
    translation += residual.e.head<3>().squaredNorm() / 15;
    rotation += residual.e.tail<3>().squaredNorm() / 15;
  }
  EXPECT_NEAR(solution.cost, cost, 1e-12 * cost);
  EXPECT_NEAR(solution.after.translation_m2, translation, 1e-15);
  EXPECT_NEAR(solution.after.rotation_rad2, rotation, 1e-15);
  EXPECT_NEAR(solution.after.total, translation + rotation, 1e-15);
  EXPECT_TRUE(std::is_sorted(solution.residuals.begin(), solution.residuals.end(),
                             [](const EdgeResidual& a, const EdgeResidual& b) { return a.edge < b.edge; }));
}

TEST(GraphSolve, UnconnectedSensorsAreUnknownAndNamed) {
  RandomRig rig = MakeRig(5, 8, 11);
  for (const char* name : {"alone", "island_a", "island_b"}) rig.graph.sensors.emplace_back(name);
  GraphEdge island = MakeEdge(100, 0, 1, Se3(), Matrix6d::Identity());
  island.frame_a = SensorId("island_a"), island.frame_b = SensorId("island_b");
  rig.graph.edges.push_back(island);
  const GraphSolution solution = Solve(rig.graph);
  for (std::size_t s = 0; s < 8; ++s) EXPECT_EQ(solution.poses[s].known, s < 5) << s;
  EXPECT_EQ(solution.poses[5].covariance, Matrix6d::Zero());
  ASSERT_EQ(solution.diagnoses.size(), 3U);
  EXPECT_EQ(solution.diagnoses[0].code, "not_connected");
  EXPECT_EQ(solution.diagnoses[0].what, "sensor alone is not connected to reference 0: it has no good edge");
  EXPECT_THAT(solution.diagnoses[1].what, testing::HasSubstr("sensor island_a is not connected to reference 0: "));
  for (const EdgeResidual& residual : solution.residuals) EXPECT_EQ(residual.in_solution, residual.edge != island.id);
  EXPECT_EQ(solution.dof, 6 * (8 - 4));
}

TEST(GraphSolve, EmptySingleAndReferenceOnlyGraphsBehave) {
  EXPECT_TRUE(Solve(Graph()).poses.empty());
  const GraphSolution lonely = Solve({Name(0), {Name(0)}, {}});
  ASSERT_EQ(lonely.poses.size(), 1U);
  EXPECT_TRUE(lonely.poses[0].known);
  const RandomRig pair = MakeRig(2, 1, 12);
  const GraphSolution solution = Solve(pair.graph);
  EXPECT_TRUE(solution.converged);
  EXPECT_EQ(solution.dof, 0);
  const GraphEdge& edge = pair.graph.edges[0];
  const Se3 T_0_1 = edge.frame_a == Name(0) ? edge.T_a_b : edge.T_a_b.Inverse();
  EXPECT_LT(Distance(solution.poses[1].T_ref_sensor, T_0_1), 1e-12);
  const GraphSolution none = Solve({Name(7), {Name(0), Name(1)}, pair.graph.edges});
  EXPECT_FALSE(none.poses[0].known);
  EXPECT_EQ(none.diagnoses.size(), 2U);
}

TEST(GraphSolve, TwiceTheSameEdgeIsTwiceTheInformation) {
  RandomRig rig = MakeRig(2, 1, 13);
  const Matrix6d single = Solve(rig.graph).poses[1].covariance;
  rig.graph.edges.push_back(rig.graph.edges[0]);
  rig.graph.edges[1].id = IdOf(1);
  const GraphSolution twice = Solve(rig.graph);
  EXPECT_LT((twice.poses[1].covariance - 0.5 * single).norm(), 1e-9 * single.norm());
  EXPECT_EQ(twice.dof, 6);
}

TEST(GraphSolve, UnusableEdgesTakeNoPartAndAreNamed) {
  RandomRig rig = MakeRig(4, 6, 14);
  GraphEdge bad = rig.graph.edges[0];
  bad.id = IdOf(50);
  bad.frame_b = bad.frame_a;
  rig.graph.edges.push_back(bad);
  bad = rig.graph.edges[1];
  bad.id = IdOf(51);
  bad.Omega(2, 2) = -bad.Omega(2, 2);
  rig.graph.edges.push_back(bad);
  bad = rig.graph.edges[2];
  bad.id = IdOf(52);
  bad.T_a_b.p_m.x() = std::nan("");
  rig.graph.edges.push_back(bad);
  bad = rig.graph.edges[3];
  bad.id = IdOf(53);
  bad.frame_b = SensorId("nobody");
  rig.graph.edges.push_back(bad);
  const GraphSolution solution = Solve(rig.graph);
  EXPECT_TRUE(solution.converged);
  EXPECT_TRUE(AllFinite(solution));
  EXPECT_EQ(std::count_if(solution.diagnoses.begin(), solution.diagnoses.end(),
                          [](const Diagnosis& d) { return d.code == "edge_not_usable"; }),
            4);
  std::string all;
  for (const Diagnosis& diagnosis : solution.diagnoses) all += diagnosis.what + "\n";
  for (const char* why : {"joins a sensor with itself", "not positive semi-definite", "not finite", "not in the graph"})
    EXPECT_THAT(all, testing::HasSubstr(why));
  EXPECT_TRUE(solution.poses[3].known);
}

TEST(GraphSolve, HalfTurnResidualsNeitherCrashNorGiveNaN) {
  for (const double angle : {M_PI, M_PI - 1e-9, M_PI + 1e-9, 3.0}) {
    RandomRig rig = MakeRig(5, 10, 15);
    Vector6d turn = Vector6d::Zero();
    turn(tangent::kRy) = angle;
    rig.graph.edges[7].T_a_b = rig.graph.edges[7].T_a_b * Se3::Exp(turn);
    const GraphSolution solution = Solve(rig.graph);
    EXPECT_TRUE(AllFinite(solution)) << angle;
    EXPECT_GT(solution.cost, 100.0) << angle;
  }
}

}  // namespace
}  // namespace rigcal::graph
