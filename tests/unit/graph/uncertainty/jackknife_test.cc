#include <gmock/gmock.h>

#include <Eigen/Dense>

#include "server/graph/uncertainty/graph_jackknife.h"
#include "tests/unit/graph/fixture.h"

namespace rigcal::graph {
namespace {

constexpr int kBlocks = 9;

std::string BlockName(int i) { return "capture " + std::to_string(i); }

// Every edge up to `with_blocks` belongs to one of two sessions and has block vectors of the given size.
BlocksByEdge GiveBlocks(Graph& graph, std::size_t with_blocks, double size, unsigned seed) {
  std::mt19937 random(seed);
  BlocksByEdge blocks;
  for (std::size_t k = 0; k < with_blocks; ++k) {
    GraphEdge& edge = graph.edges[k];
    edge.session = SessionId(std::string(64, k % 2 == 0 ? 'a' : 'b'));
    for (int i = 0; i < kBlocks; ++i)
      blocks[edge.id].blocks.push_back({BlockName(i), RandomVector(random, size, size)});
    blocks[edge.id].dof = kBlocks - 1;
  }
  return blocks;
}

// The poses after every edge's measurement was moved by its own d, by a full solve, as deviations from `at`.
Eigen::VectorXd Resolved(Graph graph, const GraphSolution& at, const std::map<EdgeId, Vector6d>& moved) {
  for (GraphEdge& edge : graph.edges)
    if (const auto d = moved.find(edge.id); d != moved.end()) edge.T_a_b = edge.T_a_b * Se3::Exp(d->second);
  const GraphSolution solution = Solve(graph);
  Eigen::VectorXd x(6 * static_cast<Eigen::Index>(at.poses.size()));
  for (std::size_t v = 0; v < at.poses.size(); ++v)
    x.segment<6>(6 * static_cast<Eigen::Index>(v)) =
        (at.poses[v].T_ref_sensor.Inverse() * solution.poses[v].T_ref_sensor).Log();
  return x;
}

Eigen::MatrixXd ScatterOfResolves(const Graph& graph, const GraphSolution& at, const BlocksByEdge& blocks,
                                  char session) {
  Eigen::MatrixXd x(6 * static_cast<Eigen::Index>(at.poses.size()), kBlocks);
  for (int i = 0; i < kBlocks; ++i) {
    std::map<EdgeId, Vector6d> moved;
    for (const GraphEdge& edge : graph.edges)
      if (!edge.session.empty() && edge.session.str().front() == session)
        moved[edge.id] = blocks.at(edge.id).blocks[static_cast<std::size_t>(i)].d;
    x.col(i) = Resolved(graph, at, moved);
  }
  const Eigen::VectorXd mean = x.rowwise().mean();
  x.colwise() -= mean;
  return (kBlocks - 1.0) / kBlocks * x * x.transpose();
}

// Central differences through full solves, for the edges without blocks.
Eigen::MatrixXd ScatterOfKnown(const Graph& graph, const GraphSolution& at) {
  const auto n = 6 * static_cast<Eigen::Index>(at.poses.size());
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(n, n);
  constexpr double kStep = 1e-5;
  for (const GraphEdge& edge : graph.edges) {
    if (!edge.session.empty()) continue;
    Eigen::MatrixXd K(n, 6);
    for (int axis = 0; axis < 6; ++axis) {
      const Vector6d d = kStep * Vector6d::Unit(axis);
      K.col(axis) = (Resolved(graph, at, {{edge.id, d}}) - Resolved(graph, at, {{edge.id, -d}})) / (2.0 * kStep);
    }
    C += K * edge.Omega.inverse() * K.transpose();
  }
  return C;
}

double WorstRatio(const Matrix6d& C, const Matrix6d& expected) {
  const Matrix6d L_inverse = Matrix6d(expected.llt().matrixL()).inverse();
  return (L_inverse * C * L_inverse.transpose() - Matrix6d::Identity()).cwiseAbs().maxCoeff();
}

TEST(GraphJackknife, AgreesWithFullResolves) {
  RandomRig rig = MakeRig(6, 13, 3, 1e-3, 1e-3);
  const BlocksByEdge blocks = GiveBlocks(rig.graph, 9, 2e-4, 4);
  const GraphSolution solution = Solve(rig.graph);
  const GraphJackknife jackknife = JackknifeGraph(rig.graph, solution, blocks);
  ASSERT_TRUE(jackknife.available);
  const Eigen::MatrixXd expected = ScatterOfResolves(rig.graph, solution, blocks, 'a') +
                                   ScatterOfResolves(rig.graph, solution, blocks, 'b') +
                                   ScatterOfKnown(rig.graph, solution);
  for (int v = 1; v < 6; ++v) {
    const auto C = SensorCovariance(jackknife, Name(static_cast<std::size_t>(v)));
    ASSERT_TRUE(C.has_value());
    EXPECT_LT(WorstRatio(*C, expected.block<6, 6>(6 * v, 6 * v)), 0.02) << v;
  }
  const auto relative = RelativeByJackknife(jackknife, solution, Name(2), Name(5));
  ASSERT_TRUE(relative.has_value());
  Eigen::MatrixXd M(6, expected.cols());
  M.setZero();
  M.block<6, 6>(0, 12) = -Adjoint(relative->T_A_B.Inverse());
  M.block<6, 6>(0, 30).setIdentity();
  EXPECT_LT(WorstRatio(relative->covariance, M * expected * M.transpose()), 0.02);
}

// By hand: frames 0, 1, 2 in a line without rotation, errors along x only matter along x. Edges 0-1 and 1-2 share
// captures and err alike; edge 0-2 is known. Weighted by equal information, x2 = (d01 + d12 + 2 d02) / 3.
TEST(GraphJackknife, ThreeFramesByHand) {
  Graph graph;
  graph.reference = Name(0);
  graph.sensors = {Name(0), Name(1), Name(2)};
  const auto at = [](double x) { return Se3{Eigen::Vector3d(x, 0, 0), Eigen::Quaterniond::Identity()}; };
  const Matrix6d Omega = 1e4 * Matrix6d::Identity();
  graph.edges = {MakeEdge(0, 0, 1, at(1), Omega), MakeEdge(1, 1, 2, at(1), Omega), MakeEdge(2, 0, 2, at(2), Omega)};
  graph.edges[0].session = graph.edges[1].session = SessionId(std::string(64, 'a'));
  BlocksByEdge blocks;
  const std::vector<double> d = {1e-3, -2e-3, 0.5e-3, 0.5e-3, -1e-3, 2e-3, -0.5e-3, -0.5e-3};
  double sum_squares = 0.0;
  for (std::size_t i = 0; i < d.size(); ++i) {
    for (int k : {0, 1})
      blocks[graph.edges[static_cast<std::size_t>(k)].id].blocks.push_back(
          {BlockName(static_cast<int>(i)), d[i] * Vector6d::Unit(0)});
    sum_squares += d[i] * d[i];
  }
  const GraphSolution solution = Solve(graph);
  const GraphJackknife jackknife = JackknifeGraph(graph, solution, blocks);
  ASSERT_TRUE(jackknife.available);
  const double C_shared = 0.875 * sum_squares;  // (m-1)/m, mean zero
  // x1 = (2 d01 - d12 + d02)/3, x2 = (d01 + d12 + 2 d02)/3 with d01 = d12 = s, d02 = t.
  EXPECT_NEAR((*SensorCovariance(jackknife, Name(1)))(0, 0), C_shared / 9 + 1e-4 / 9, 1e-12);
  EXPECT_NEAR((*SensorCovariance(jackknife, Name(2)))(0, 0), 4 * C_shared / 9 + 4e-4 / 9, 1e-12);
  // e02 = x2 - t = (2 s - t)/3.
  EXPECT_NEAR(jackknife.residuals[2].in_solution ? 1.0 : 0.0, 1.0, 0.0);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(jackknife.residuals[k].C_e(0, 0), (4 * C_shared + 1e-4) / 9, 1e-12) << k;
  // Eight blocks, and an edge that is known by itself.
  EXPECT_EQ(jackknife.dof[0], 0.0);
  for (const std::size_t v : {1, 2}) EXPECT_GT(jackknife.dof[v], 7.01) << v;
}

// One session of 40 blocks, of which every fourth is so much larger.
double DofOfUneven(double larger) {
  constexpr int kMany = 40;
  RandomRig rig = MakeRig(4, 6, 3, 1e-3, 1e-3);
  std::mt19937 random(8);
  BlocksByEdge blocks;
  for (GraphEdge& edge : rig.graph.edges) {
    edge.session = SessionId(std::string(64, 'a'));
    for (int i = 0; i < kMany; ++i) {
      const double size = 2e-4 * (i % 4 == 0 ? larger : 1.0);
      blocks[edge.id].blocks.push_back({BlockName(i), RandomVector(random, size, size)});
    }
    blocks[edge.id].dof = kMany - 1;
  }
  const GraphJackknife jackknife = JackknifeGraph(rig.graph, Solve(rig.graph), blocks);
  return jackknife.available ? *std::min_element(jackknife.dof.begin() + 1, jackknife.dof.end()) : 0.0;
}

TEST(GraphJackknife, BlocksThatCarryUnevenlyCountForFewer) {
  EXPECT_GT(DofOfUneven(1.0), 34.0);
  EXPECT_LT(DofOfUneven(5.0), 20.0);
}

TEST(GraphJackknife, DegreesOfFreedomAreThoseOfTheSessions) {
  RandomRig rig = MakeRig(6, 13, 3, 1e-3, 1e-3);
  const BlocksByEdge blocks = GiveBlocks(rig.graph, 13, 2e-4, 4);
  const GraphJackknife two_sessions = JackknifeGraph(rig.graph, Solve(rig.graph), blocks);
  for (GraphEdge& edge : rig.graph.edges) edge.session = rig.graph.edges.front().session;
  GraphSolution solution = Solve(rig.graph);
  const GraphJackknife one_session = JackknifeGraph(rig.graph, solution, blocks);
  ASSERT_TRUE(two_sessions.available && one_session.available);
  for (std::size_t v = 1; v < 6; ++v) {
    EXPECT_NEAR(one_session.dof[v], kBlocks - 1, 1e-9) << v;
    EXPECT_GT(two_sessions.dof[v], kBlocks - 1) << v;
    EXPECT_LE(two_sessions.dof[v], 2 * (kBlocks - 1) + 1e-9) << v;
  }
  ApplyJackknifeCovariance(rig.graph, one_session, solution);
  EXPECT_EQ(solution.poses[3].dof, one_session.dof[3]);
}

// One edge per block vector set whose scatter is its covariance: then the jackknife and H^-1 are the same.
TEST(GraphJackknife, IsAnalyticWhereBlocksSayWhatOmegaSays) {
  RandomRig rig = MakeRig(5, 8, 11, 1e-4, 1e-4);
  BlocksByEdge blocks;
  for (GraphEdge& edge : rig.graph.edges) {
    const Matrix6d L = edge.Omega.inverse().llt().matrixL();
    const double scale = std::sqrt(12.0 / 11.0 / 2.0);  // (m-1)/m over m = 12 blocks, each direction twice
    for (int axis = 0; axis < 6; ++axis)
      for (const double sign : {1.0, -1.0})
        blocks[edge.id].blocks.push_back({BlockName(axis) + (sign > 0 ? "+" : "-"), sign * scale * L.col(axis)});
  }
  GraphSolution solution = Solve(rig.graph);
  const GraphJackknife jackknife = JackknifeGraph(rig.graph, solution, blocks);
  ASSERT_TRUE(jackknife.available);
  for (std::size_t v = 1; v < 5; ++v) {
    EXPECT_LT(WorstRatio(*SensorCovariance(jackknife, Name(v)), solution.poses[v].covariance), 2e-3) << v;
    const auto analytic = Relative(rig.graph, solution, Name(v), Name(v % 4 + 1));
    const auto honest = RelativeByJackknife(jackknife, solution, Name(v), Name(v % 4 + 1));
    EXPECT_LT(WorstRatio(honest->covariance, analytic->covariance), 2e-3) << v;
  }
  const GraphSolution before = solution;
  ApplyJackknifeCovariance(rig.graph, jackknife, solution);
  EXPECT_FALSE(solution.poses[0].by_jackknife);
  EXPECT_TRUE(solution.poses[0].covariance.isZero(0.0));
  for (std::size_t v = 1; v < 5; ++v) {
    EXPECT_TRUE(solution.poses[v].by_jackknife);
    EXPECT_EQ(solution.poses[v].covariance_analytic, before.poses[v].covariance);
    EXPECT_LT((SigmaRatio(solution.poses[v].covariance, before.poses[v].covariance) - Vector6d::Ones()).norm(), 1e-3);
  }
}

TEST(GraphJackknife, OrderOfEdgesDoesNotMatter) {
  RandomRig rig = MakeRig(7, 15, 5, 1e-3, 1e-3);
  const BlocksByEdge blocks = GiveBlocks(rig.graph, 10, 1e-3, 6);
  Graph shuffled = rig.graph;
  std::reverse(shuffled.edges.begin(), shuffled.edges.end());
  GraphSolution a = Solve(rig.graph), b = Solve(shuffled);
  ApplyJackknifeCovariance(rig.graph, JackknifeGraph(rig.graph, a, blocks), a);
  ApplyJackknifeCovariance(shuffled, JackknifeGraph(shuffled, b, blocks), b);
  EXPECT_TRUE(a.poses[1].by_jackknife);
  EXPECT_TRUE(SameBytes(a, b));
  for (std::size_t k = 0; k < a.residuals.size(); ++k) EXPECT_EQ(a.residuals[k].t_squared, b.residuals[k].t_squared);
}

TEST(GraphJackknife, GivenConstantsAddToTheirEdge) {
  RandomRig rig = MakeRig(2, 1, 8, 1e-3, 1e-3);
  BlocksByEdge blocks = GiveBlocks(rig.graph, 1, 1e-4, 9);
  rig.graph.edges[0].frame_a = Name(0), rig.graph.edges[0].frame_b = Name(1);
  const GraphSolution solution = Solve(rig.graph);
  const Matrix6d without = *SensorCovariance(JackknifeGraph(rig.graph, solution, blocks), Name(1));
  Matrix6d C_given = Matrix6d::Zero();
  C_given(2, 2) = 4e-6;
  blocks.begin()->second.C_given = C_given;
  const Matrix6d with = *SensorCovariance(JackknifeGraph(rig.graph, solution, blocks), Name(1));
  EXPECT_LT((with - without - C_given).cwiseAbs().maxCoeff(), 1e-12);
}

// A board that is given too large is so on every visit: two edges of two sessions are off alike, and so is their mean.
TEST(GraphJackknife, GivenConstantsAreTheSameInAllSessions) {
  const Matrix6d Omega = 1e6 * Matrix6d::Identity();
  Graph graph;
  graph.reference = Name(0);
  graph.sensors = {Name(0), Name(1)};
  graph.edges = {MakeEdge(0, 0, 1, Se3(), Omega), MakeEdge(1, 0, 1, Se3(), Omega)};
  BlocksByEdge blocks = GiveBlocks(graph, 2, 1e-4, 9);
  ASSERT_NE(graph.edges[0].session, graph.edges[1].session);
  const GraphSolution solution = Solve(graph);
  const Matrix6d without = *SensorCovariance(JackknifeGraph(graph, solution, blocks), Name(1));
  const Vector6d shift = 2e-3 * Vector6d::Unit(2);
  for (auto& [id, own] : blocks) own.shifts["size of board front"] = {shift};
  const Matrix6d with = *SensorCovariance(JackknifeGraph(graph, solution, blocks), Name(1));
  EXPECT_LT((with - without - shift * shift.transpose()).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(GraphJackknife, BlocksThatSayTooLittleAreLeftOut) {
  std::mt19937 random(1);
  Edge edge;
  edge.id = IdOf(0);
  edge.state = EdgeState::kGood;
  edge.uncertainty = FromInformation(Matrix6d::Identity(), UncertaintySource::kJackknife, 11);
  for (int i = 0; i < 12; ++i) edge.uncertainty.blocks.push_back({BlockName(i), RandomVector(random, 1.0, 1.0)});
  edge.uncertainty.contributions = {{"square", Matrix6d::Identity()}, {"lens", Matrix6d::Identity()}};
  const BlocksByEdge blocks = BlocksOf({edge});
  ASSERT_EQ(blocks.size(), 1u);
  EXPECT_EQ(blocks.begin()->second.C_given, 2.0 * Matrix6d::Identity());
  EXPECT_EQ(blocks.begin()->second.dof, 11);
  Edge failed = edge, twice = edge, flat = edge, few = edge;
  failed.state = EdgeState::kFailed;
  twice.uncertainty.blocks[3].block_id = twice.uncertainty.blocks[4].block_id;
  for (BlockVector& block : flat.uncertainty.blocks) block.d(2) = 0.0;
  few.uncertainty.blocks.resize(7);
  for (const Edge& unusable : {failed, twice, flat, few}) EXPECT_TRUE(BlocksOf({unusable}).empty());
}

TEST(GraphJackknife, OddGraphs) {
  EXPECT_FALSE(JackknifeGraph(Graph(), Solve(Graph()), {}).available);
  RandomRig rig = MakeRig(4, 5, 12, 1e-3, 1e-3);
  GraphSolution solution = Solve(rig.graph);
  EXPECT_FALSE(JackknifeGraph(rig.graph, solution, {}).available);
  BlocksByEdge one_block;
  one_block[rig.graph.edges[0].id].blocks = {{"alone", Vector6d::Ones()}};
  EXPECT_FALSE(JackknifeGraph(rig.graph, solution, one_block).available);
  // A sensor that nothing ties to the reference, an edge to itself, and an edge twice.
  const BlocksByEdge blocks = GiveBlocks(rig.graph, 3, 1e-3, 13);
  rig.graph.sensors.push_back(Name(9));
  rig.graph.edges.push_back(MakeEdge(90, 1, 1, Se3(), Matrix6d::Identity()));
  rig.graph.edges.push_back(rig.graph.edges[0]);
  solution = Solve(rig.graph);
  const GraphJackknife jackknife = JackknifeGraph(rig.graph, solution, blocks);
  ASSERT_TRUE(jackknife.available);
  EXPECT_EQ(SensorCovariance(jackknife, Name(9)).error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(SensorCovariance(jackknife, Name(77)).error().code, ErrorCode::kNotFound);
  EXPECT_FALSE(RelativeByJackknife(jackknife, solution, Name(1), Name(9)).has_value());
  EXPECT_TRUE(SensorCovariance(jackknife, Name(0))->isZero(0.0));
}

}  // namespace
}  // namespace rigcal::graph
