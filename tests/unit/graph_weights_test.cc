// Information that the blocks made errs as they do: what that does to the covariance of the result.
#include <gmock/gmock.h>

#include <Eigen/Dense>

#include "server/graph/graph_jackknife.h"
#include "server/graph/jackknife_sources.h"
#include "server/graph/solved_poses.h"
#include "server/math/jackknife.h"
#include "tests/unit/graph_fixture.h"

namespace rigcal::graph {
namespace {

constexpr std::size_t kSensors = 6;
constexpr int kCaptures = 20;
constexpr double kSigma_m = 2e-3, kSigma_rad = 2e-3;

// Every capture of one session errs once per edge; edges of all pairs, each the mean of its captures.
struct Visit {
  RandomRig rig;
  std::vector<Edge> edges;
};

Matrix6d ModelOf() {
  Vector6d variance;
  variance << Eigen::Vector3d::Constant(kSigma_m * kSigma_m), Eigen::Vector3d::Constant(kSigma_rad * kSigma_rad);
  return Matrix6d(variance.asDiagonal()) / kCaptures;
}

std::vector<Vector6d> ShiftsOf(const Edge& edge) {
  std::vector<Vector6d> d;
  for (const BlockVector& block : edge.uncertainty.blocks) d.push_back(block.d);
  return d;
}

Edge MeanOfCaptures(std::size_t number, std::size_t a, std::size_t b, const Se3& truth, const Matrix6d& C_model,
                    std::mt19937& random) {
  Edge edge;
  edge.id = IdOf(number);
  edge.state = EdgeState::kGood;
  edge.frame_a = Name(a), edge.frame_b = Name(b);
  edge.session = SessionId(std::string(64, 'a'));
  std::vector<Vector6d> errors;
  Vector6d mean = Vector6d::Zero();
  for (int i = 0; i < kCaptures; ++i) {
    errors.push_back(RandomVector(random, kSigma_m, kSigma_rad));
    mean += errors.back() / kCaptures;
  }
  std::vector<BlockVector> blocks;
  std::vector<Vector6d> d;
  for (int i = 0; i < kCaptures; ++i) {
    d.push_back(-(errors[static_cast<std::size_t>(i)] - mean) / (kCaptures - 1));
    blocks.push_back({"capture " + std::to_string(100 + i), d.back()});
  }
  const auto [C, share] = ShrinkTowardsModel(JackknifeCovariance(d), C_model, kCaptures);
  edge.T_a_b = truth * Se3::Exp(mean);
  edge.uncertainty = FromCovariance(C, UncertaintySource::kJackknife, kCaptures - 1).value();
  edge.uncertainty.jackknife_ratio = share;
  edge.uncertainty.blocks = std::move(blocks);
  return edge;
}

// The model is right, or that many times too sure of its sigmas.
Visit VisitOf(unsigned seed, double too_sure = 1.0) {
  Visit visit{MakeRig(kSensors, kSensors - 1, 17), {}};
  std::mt19937 random(seed);
  for (std::size_t a = 0; a < kSensors; ++a)
    for (std::size_t b = a + 1; b < kSensors; ++b)
      visit.edges.push_back(MeanOfCaptures(visit.edges.size(), a, b, visit.rig.truth[a].Inverse() * visit.rig.truth[b],
                                           ModelOf() / (too_sure * too_sure), random));
  return visit;
}

// The edge's pose as it would be without a capture.
Edge MovedByCapture(Edge edge, std::size_t i) {
  edge.T_a_b = edge.T_a_b * Se3::Exp(edge.uncertainty.blocks[i].d);
  return edge;
}

// And its covariance too, scaled to as many captures as it had.
Edge WithoutCapture(const Edge& whole, std::size_t i) {
  Edge edge = MovedByCapture(whole, i);
  std::vector<Vector6d> d = ShiftsOf(edge);
  d.erase(d.begin() + static_cast<std::ptrdiff_t>(i));
  const double scale = (kCaptures - 1.0) * (kCaptures - 1.0) / (kCaptures * (kCaptures - 2.0));
  const Matrix6d C_jack = scale * (kCaptures - 1.0) / (kCaptures - 2.0) * JackknifeCovariance(d);
  const double share = whole.uncertainty.jackknife_ratio;
  const Matrix6d C = share * C_jack + (1.0 - share) * ModelOf();
  edge.uncertainty = FromCovariance(C, UncertaintySource::kJackknife, kCaptures - 1).value();
  return edge;
}

// How all poses move when `changed` takes a capture out of every edge; one column per capture.
template <class Changed>
Eigen::MatrixXd Solutions(const Visit& visit, const GraphSolution& solution, const Changed& changed) {
  Eigen::MatrixXd x(6 * (kSensors - 1), kCaptures);
  for (int i = 0; i < kCaptures; ++i) {
    std::vector<Edge> edges;
    for (const Edge& edge : visit.edges) edges.push_back(changed(edge, static_cast<std::size_t>(i)));
    const GraphSolution without = Solve(GraphOf(edges, Name(0)));
    for (std::size_t v = 1; v < kSensors; ++v)
      x.block<6, 1>(6 * (static_cast<Eigen::Index>(v) - 1), i) =
          (solution.poses[v].T_ref_sensor.Inverse() * without.poses[v].T_ref_sensor).Log();
  }
  return x;
}

// What the weights do is of two blocks together: 1 / sqrt(2) of it counts.
TEST(GraphWeights, AreLeftOutWithTheirBlocks) {
  const Visit visit = VisitOf(1);
  const Graph graph = GraphOf(visit.edges, Name(0));
  const GraphSolution solution = Solve(graph);
  const Eigen::MatrixXd moved = Solutions(visit, solution, MovedByCapture);
  const Eigen::MatrixXd without = Solutions(visit, solution, WithoutCapture);
  Eigen::MatrixXd x = moved + std::sqrt(0.5) * (without - moved);
  const Eigen::VectorXd mean = x.rowwise().mean();
  x.colwise() -= mean;
  const Eigen::VectorXd expected = (kCaptures - 1.0) / kCaptures * x.rowwise().squaredNorm();
  BlocksByEdge blocks = BlocksOf(visit.edges);
  const GraphJackknife jackknife = JackknifeGraph(graph, solution, blocks);
  for (auto& [id, own] : blocks) own.weight_share = 0.0;
  const GraphJackknife held = JackknifeGraph(graph, solution, blocks);
  for (std::size_t v = 1; v < kSensors; ++v) {
    const Vector6d full = expected.segment<6>(6 * (static_cast<Eigen::Index>(v) - 1));
    const Vector6d ratio = SensorCovariance(jackknife, Name(v))->diagonal().cwiseQuotient(full);
    EXPECT_LT((ratio - Vector6d::Ones()).cwiseAbs().maxCoeff(), 0.05) << ratio.transpose();
    EXPECT_LT(SensorCovariance(held, Name(v))->diagonal().cwiseQuotient(full).mean(), 0.9);
  }
}

// An edge that has few of the session's captures, one of which says almost all: its weights are its own affair, and
// without that capture they are still weights.
TEST(GraphWeights, AreOfTheCapturesThatAnEdgeHas) {
  Visit visit = VisitOf(3);
  Edge& few = visit.edges[0];
  few.uncertainty.blocks.resize(9);
  few.uncertainty.blocks[4].d *= 30;
  const auto [C, share] = ShrinkTowardsModel(JackknifeCovariance(ShiftsOf(few)), 1e-2 * ModelOf(), 9);
  std::vector<BlockVector> blocks = few.uncertainty.blocks;
  few.uncertainty = FromCovariance(C, UncertaintySource::kJackknife, 8).value();
  few.uncertainty.jackknife_ratio = share;
  few.uncertainty.blocks = std::move(blocks);
  const auto weight_in = [](const std::vector<Edge>& edges) {
    const Graph graph = GraphOf(edges, Name(0));
    const Problem problem = MakeProblem(graph);
    const BlocksByEdge own = BlocksOf(edges);
    JackknifeWork work{graph, problem, own, {}};
    const Poses T_ref = SolvedPoses(graph, problem, Solve(graph));
    for (const Constraint& constraint : problem.constraints) work.jacobians.push_back(JacobianOf(constraint, T_ref));
    const std::vector<ErrorSource> sources = SharedSourcesOf(work);
    for (const ErrorPart& part : sources.front().parts)
      if (work.EdgeOf(part.constraint).id == IdOf(0)) return part.weight.value();
    return WeightBlocks{};
  };
  const WeightBlocks alone = weight_in({few}), among = weight_in(visit.edges);
  ASSERT_EQ(alone.d.cols(), 9);
  ASSERT_EQ(among.d.cols(), kCaptures);
  EXPECT_LT((among.d * among.d.transpose() - alone.d * alone.d.transpose()).norm(), 1e-12 * alone.d.squaredNorm());
  const Eigen::MatrixXd pull =
      PullByWeight(among, few.uncertainty.Omega, Eigen::MatrixXd::Constant(6, kCaptures, 1e-3));
  EXPECT_TRUE(pull.allFinite());
  for (Eigen::Index i = 0; i < kCaptures; ++i) {
    if (among.own[static_cast<std::size_t>(i)] == 0) continue;
    const Vector6d d = among.d.col(i);
    const Matrix6d without = C + among.share / 7.0 * (among.d * among.d.transpose() - 9.0 * d * d.transpose());
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix6d>(without).eigenvalues()(0), 0.0) << i;
  }
}

// What was estimated before the ratio was kept counted the model like seven blocks; a covariance that is smaller than
// that makes it was not made so.
TEST(GraphWeights, WithoutARatioAreThoseOfSevenBlocks) {
  Edge edge = VisitOf(1).edges.front();
  const Matrix6d C_jack = JackknifeCovariance(ShiftsOf(edge));
  const double seven = JackknifeRatioMax(kCaptures);
  const auto share_of = [&](double size) {
    const std::vector<BlockVector> blocks = edge.uncertainty.blocks;
    const Matrix6d C = size * (seven * C_jack + (1.0 - seven) * ModelOf());
    edge.uncertainty = FromCovariance(C, UncertaintySource::kJackknife, kCaptures - 1).value();
    edge.uncertainty.blocks = blocks;
    return BlocksOf({edge}).at(edge.id).weight_share;
  };
  EXPECT_DOUBLE_EQ(share_of(1.0), seven);
  EXPECT_DOUBLE_EQ(share_of(0.5), 0.0);
}

// The mean of squares of errors in their sigmas.
double MeanSquare(unsigned visits, double too_sure) {
  double squares = 0.0;
  for (unsigned seed = 0; seed < visits; ++seed) {
    const Visit visit = VisitOf(100 + seed, too_sure);
    const Graph graph = GraphOf(visit.edges, Name(0));
    GraphSolution solution = Solve(graph);
    TakeHonest(graph, JackknifeGraph(graph, solution, BlocksOf(visit.edges)), solution);
    for (std::size_t v = 1; v < kSensors; ++v) {
      const Vector6d error = (solution.poses[v].T_ref_sensor.Inverse() * visit.rig.truth[v]).Log();
      squares +=
          error.cwiseAbs2().cwiseQuotient(solution.poses[v].covariance.diagonal()).mean() / (visits * (kSensors - 1.0));
    }
  }
  return squares;
}

// A ratio that someone else told, with a block that alone shows a direction.
TEST(GraphWeights, AreFiniteWithoutTheOnlyBlockOfADirection) {
  Edge edge = VisitOf(1).edges.front();
  for (BlockVector& block : edge.uncertainty.blocks) block.d(5) = 0.0;
  edge.uncertainty.blocks[4].d(5) = 1e-3;
  const std::vector<BlockVector> blocks = edge.uncertainty.blocks;
  for (const double size : {1.0, JackknifeRatioMax(kCaptures)}) {
    const Matrix6d C = size * JackknifeCovariance(ShiftsOf(edge));
    edge.uncertainty = FromCovariance(C, UncertaintySource::kJackknife, kCaptures - 1).value();
    edge.uncertainty.blocks = blocks;
    edge.uncertainty.jackknife_ratio = 1.0;
    const double share = BlocksOf({edge}).at(edge.id).weight_share;
    ASSERT_GT(share, 0.5);
    WeightBlocks weight{Eigen::MatrixXd(6, kCaptures), std::vector<char>(kCaptures, 1), share};
    Vector6d mean = Vector6d::Zero();
    for (const BlockVector& block : blocks) mean += block.d / kCaptures;
    for (Eigen::Index i = 0; i < kCaptures; ++i)
      weight.d.col(i) = BlockScale(kCaptures) * (blocks[static_cast<std::size_t>(i)].d - mean);
    const Eigen::MatrixXd residuals = Eigen::MatrixXd::Constant(6, kCaptures, 1e-3);
    EXPECT_LT(PullByWeight(weight, edge.uncertainty.Omega, residuals).norm(), 1e3 * residuals.norm());
  }
}

// A variance of 19 degrees of freedom that is right on average makes the mean 19 / 17. With weights held it is 1.5
// (weights that fit chance in the blocks find little chance left in them), with all of what weights do 0.98.
TEST(GraphWeights, SigmasHoldWhereTwentyCapturesMadeThem) {
  const double right = MeanSquare(1000, 1.0), too_sure = MeanSquare(600, 2.0);
  RecordProperty("mean_squared_ratio", std::to_string(right));
  RecordProperty("mean_squared_ratio_of_too_sure_models", std::to_string(too_sure));
  EXPECT_NEAR(right, 19.0 / 17.0, 0.08);  // the spread of the mean is below 0.02
  EXPECT_NEAR(too_sure, 19.0 / 17.0, 0.08);
}

}  // namespace
}  // namespace rigcal::graph
