#include <gmock/gmock.h>

#include <Eigen/Cholesky>

#include "tests/unit/graph/fixture.h"

namespace rigcal::graph {
namespace {

// Error on one axis of one edge shows up in that variance, in that sensor's own axes, and nowhere else.
TEST(GraphMarginals, VarianceSitsOnTheAxisThatIsUncertain) {
  for (int axis = 0; axis < 6; ++axis) {
    RandomRig rig = MakeRig(2, 1, 40, 0.001, 0.001, false);
    GraphEdge& edge = rig.graph.edges[0];
    edge.frame_a = Name(0), edge.frame_b = Name(1);
    edge.Omega(axis, axis) = 25.0;
    const Matrix6d C = Solve(rig.graph).poses[1].covariance;
    Matrix6d expected = 1e-6 * Matrix6d::Identity();
    expected(axis, axis) = 0.04;
    EXPECT_LT((C - expected).cwiseAbs().maxCoeff(), 1e-10) << axis;
  }
}

// Fresh noise on every edge, 4000 times: the scatter of the solved poses is what the marginals and Relative() say.
TEST(GraphMarginals, AreTheScatterOfMonteCarlo) {
  const RandomRig rig = MakeRig(5, 9, 41, 0.004, 0.004);
  Graph graph = rig.graph;
  for (GraphEdge& edge : graph.edges)
    edge.T_a_b = rig.truth[std::stoul(edge.frame_a.str())].Inverse() * rig.truth[std::stoul(edge.frame_b.str())];
  const Graph exact = graph;
  const GraphSolution at_truth = Solve(exact);
  const auto relative = Relative(exact, at_truth, Name(2), Name(4));
  ASSERT_TRUE(relative.has_value());
  std::mt19937 random(42);
  constexpr int kDraws = 4000;
  std::vector<Matrix6d> scatter(5, Matrix6d::Zero());
  Matrix6d scatter_2_4 = Matrix6d::Zero();
  SolveOptions options;
  options.marginals = false;
  for (int draw = 0; draw < kDraws; ++draw) {
    for (std::size_t k = 0; k < graph.edges.size(); ++k)
      graph.edges[k].T_a_b = exact.edges[k].T_a_b * Se3::Exp(DrawError(random, exact.edges[k].Omega));
    const GraphSolution solution = Solve(graph, options);
    for (std::size_t v = 1; v < 5; ++v) {
      const Vector6d xi = (rig.truth[v].Inverse() * solution.poses[v].T_ref_sensor).Log();
      scatter[v] += xi * xi.transpose() / kDraws;
    }
    const Se3 T_2_4 = solution.poses[2].T_ref_sensor.Inverse() * solution.poses[4].T_ref_sensor;
    const Vector6d xi = (relative->T_A_B.Inverse() * T_2_4).Log();
    scatter_2_4 += xi * xi.transpose() / kDraws;
  }
  // Whitened, the sample covariance of 4000 draws is the identity with entries of sigma 0.016 to 0.022.
  const auto whitened_error = [](const Matrix6d& C, const Matrix6d& sample) {
    const Matrix6d L = C.llt().matrixL();
    const Matrix6d L_inverse = L.inverse();
    return (L_inverse * sample * L_inverse.transpose() - Matrix6d::Identity()).cwiseAbs().maxCoeff();
  };
  for (std::size_t v = 1; v < 5; ++v) EXPECT_LT(whitened_error(at_truth.poses[v].covariance, scatter[v]), 0.13) << v;
  EXPECT_LT(whitened_error(relative->covariance, scatter_2_4), 0.13);
}

// Mean over edges of tr(Omega Cov(edge)) / 6 is (N_V - 1) / N_E exactly, where residuals vanish: the trace of a
// projector.
TEST(GraphMarginals, MeanEdgeUncertaintyIsVerticesOverEdges) {
  for (const std::size_t vertices : {std::size_t{12}, std::size_t{60}}) {
    const std::size_t edges = 4 * vertices;
    RandomRig rig = MakeRig(vertices, edges, 43, 0.01, 0.01, false);
    for (GraphEdge& edge : rig.graph.edges)
      edge.T_a_b = rig.truth[std::stoul(edge.frame_a.str())].Inverse() * rig.truth[std::stoul(edge.frame_b.str())];
    const GraphSolution solution = Solve(rig.graph);
    double sum = 0.0;
    for (const GraphEdge& edge : rig.graph.edges) {
      const auto relative = Relative(rig.graph, solution, edge.frame_a, edge.frame_b);
      ASSERT_TRUE(relative.has_value());
      sum += (edge.Omega * relative->covariance).trace() / 6;
    }
    EXPECT_NEAR(sum / static_cast<double>(edges), static_cast<double>(vertices - 1) / static_cast<double>(edges), 1e-9);
  }
}

TEST(GraphRelative, AgreesWithMarginalsAndIsIdentityForOneSensor) {
  const RandomRig rig = MakeRig(9, 20, 44);
  const GraphSolution solution = Solve(rig.graph);
  const auto from_reference = Relative(rig.graph, solution, Name(0), Name(5));
  ASSERT_TRUE(from_reference.has_value());
  EXPECT_LT((from_reference->covariance - solution.poses[5].covariance).norm(),
            1e-9 * solution.poses[5].covariance.norm());
  const auto there = Relative(rig.graph, solution, Name(3), Name(7)),
             back = Relative(rig.graph, solution, Name(7), Name(3));
  ASSERT_TRUE(there && back);
  EXPECT_LT(Distance(there->T_A_B, back->T_A_B.Inverse()), 1e-12);
  EXPECT_LT((InverseCovariance(there->T_A_B, there->covariance) - back->covariance).norm(),
            1e-9 * back->covariance.norm());
  const auto same = Relative(rig.graph, solution, Name(3), Name(3));
  ASSERT_TRUE(same.has_value());
  EXPECT_EQ(same->covariance, Matrix6d::Zero());
}

TEST(GraphRelative, RefusesUnknownAndUnconnectedSensorsByName) {
  RandomRig rig = MakeRig(4, 5, 45);
  rig.graph.sensors.emplace_back("loose");
  const GraphSolution solution = Solve(rig.graph);
  const auto unknown = Relative(rig.graph, solution, Name(0), SensorId("nobody"));
  ASSERT_FALSE(unknown.has_value());
  EXPECT_EQ(unknown.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(unknown.error().what, testing::HasSubstr("nobody"));
  const auto loose = Relative(rig.graph, solution, SensorId("loose"), Name(1));
  ASSERT_FALSE(loose.has_value());
  EXPECT_EQ(loose.error().code, ErrorCode::kInvalidInput);
  EXPECT_THAT(loose.error().what, testing::HasSubstr("sensor loose is not connected to reference 0"));
}

}  // namespace
}  // namespace rigcal::graph
