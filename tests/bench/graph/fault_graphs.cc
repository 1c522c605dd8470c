#include "tests/bench/graph/fault_graphs.h"

#include <cmath>

#include "server/math/jackknife.h"

namespace rigcal::graph {
namespace {

constexpr double kRadiansPerDegree = 1.0 / 57.29577951308232;
constexpr double kSigma_m = 0.005, kSigma_rad = 0.3 * kRadiansPerDegree;
constexpr double kGross_m = 0.1, kGross_rad = 10.0 * kRadiansPerDegree;
constexpr double kPairShare = 0.3;  // of a camera's error, an edge's own: corners of one picture used in several pairs

// 10 cm and 10 degrees, in any direction.
Vector6d GrossError(std::mt19937& random) {
  Vector6d error = RandomVector(random, 1.0, 1.0);
  error.head<3>() *= kGross_m / error.head<3>().norm();
  error.tail<3>() *= kGross_rad / error.tail<3>().norm();
  return error;
}

Matrix6d EdgeCovariance() {
  Matrix6d C = Matrix6d::Zero();
  C.diagonal() << Eigen::Vector3d::Constant(kSigma_m * kSigma_m), Eigen::Vector3d::Constant(kSigma_rad * kSigma_rad);
  return C;
}

// The answer of blocks that err by `errors`: their mean; its information from their scatter.
void TakeBlocks(const std::vector<Vector6d>& errors, const Matrix6d& C_model, bool shrink, GraphEdge& edge,
                EdgeBlocks& own) {
  const auto m = static_cast<int>(errors.size());
  Vector6d mean = Vector6d::Zero();
  for (const Vector6d& error : errors) mean += error / m;
  std::vector<Vector6d> d;
  for (int i = 0; i < m; ++i) {
    d.push_back(-(errors[static_cast<std::size_t>(i)] - mean) / (m - 1));
    own.blocks.push_back({std::to_string(100 + i), d.back()});
  }
  own.dof = edge.dof = m - 1;
  const Matrix6d C = shrink ? JackknifeOrModel(d, C_model) : JackknifeCovariance(d);
  edge.Omega = Symmetrized(C.inverse());
  edge.T_a_b = (edge.T_a_b * Se3::Exp(mean)).Normalized();
}

void EstimateApart(const Information& information, std::mt19937& random, FaultGraph& made) {
  for (GraphEdge& edge : made.rig.graph.edges) {
    std::vector<Vector6d> errors;
    for (int i = 0; i < information.blocks; ++i)
      errors.push_back(std::sqrt(information.blocks) * RandomVector(random, kSigma_m, kSigma_rad));
    TakeBlocks(errors, EdgeCovariance(), information.source == Source::kSessions, edge, made.blocks[edge.id]);
    edge.session = SessionId(edge.id.str());
  }
  if (information.source == Source::kScatter) made.blocks.clear();
}

// Every capture errs once per camera, alike in all its pairs, and a little per pair.
void EstimateTogether(int m, std::mt19937& random, FaultGraph& made) {
  const double share = std::sqrt(m / 2.0);
  std::vector<std::vector<Vector6d>> of_camera(kFaultSensors);
  for (auto& errors : of_camera)
    for (int i = 0; i < m; ++i) errors.push_back(share * RandomVector(random, kSigma_m, kSigma_rad));
  for (GraphEdge& edge : made.rig.graph.edges) {
    const auto a = std::stoul(edge.frame_a.str()), b = std::stoul(edge.frame_b.str());
    const Matrix6d A = Adjoint(edge.T_a_b.Inverse());
    std::vector<Vector6d> errors;
    for (std::size_t i = 0; i < static_cast<std::size_t>(m); ++i)
      errors.push_back(of_camera[b][i] - A * of_camera[a][i] +
                       kPairShare * share * RandomVector(random, kSigma_m, kSigma_rad));
    const Matrix6d C = EdgeCovariance() / 2.0;
    const Matrix6d C_model = (1.0 + kPairShare * kPairShare) * C + A * C * A.transpose();
    TakeBlocks(errors, C_model, true, edge, made.blocks[edge.id]);
    edge.session = SessionId(std::string(64, 'a'));
  }
}

// Information that is known; edges are the truth.
RandomRig MakeTruth(std::mt19937& random) {
  RandomRig rig = MakeRig(kFaultSensors, 0, static_cast<unsigned>(random()));
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t a = 0; a < kFaultSensors; ++a)
    for (std::size_t b = a + 1; b < kFaultSensors; ++b) pairs.emplace_back(a, b);
  for (std::size_t k = pairs.size() - 1; k > 0; --k) std::swap(pairs[k], pairs[random() % (k + 1)]);
  const Matrix6d Omega = EdgeCovariance().inverse();
  for (std::size_t k = 0; k < kFaultEdges; ++k) {
    const auto [a, b] = pairs[k];
    rig.graph.edges.push_back(MakeEdge(k, a, b, (rig.truth[a].Inverse() * rig.truth[b]).Normalized(), Omega));
  }
  return rig;
}

}  // namespace

FaultGraph MakeFaultGraph(std::mt19937& random, const Information& information) {
  FaultGraph made{MakeTruth(random), {}};
  if (information.source == Source::kRig) {
    EstimateTogether(information.blocks, random, made);
  } else if (information.source != Source::kKnown) {
    EstimateApart(information, random, made);
  } else {
    for (GraphEdge& edge : made.rig.graph.edges)
      edge.T_a_b = (edge.T_a_b * Se3::Exp(DrawError(random, edge.Omega))).Normalized();
  }
  return made;
}

std::set<EdgeId> SpoilEdges(RandomRig& rig, std::size_t count, std::mt19937& random) {
  std::set<EdgeId> wrong;
  while (wrong.size() < count) {
    GraphEdge& edge = rig.graph.edges[random() % rig.graph.edges.size()];
    if (wrong.insert(edge.id).second) edge.T_a_b = edge.T_a_b * Se3::Exp(GrossError(random));
  }
  return wrong;
}

std::set<EdgeId> MoveSensor(RandomRig& rig, std::size_t sensor, std::size_t count, std::mt19937& random) {
  const Se3 T_moved = Se3::Exp(GrossError(random));
  std::set<EdgeId> wrong;
  for (GraphEdge& edge : rig.graph.edges) {
    if (wrong.size() == count) break;
    if (edge.frame_a != Name(sensor) && edge.frame_b != Name(sensor)) continue;
    edge.T_a_b = edge.frame_b == Name(sensor) ? edge.T_a_b * T_moved : T_moved.Inverse() * edge.T_a_b;
    wrong.insert(edge.id);
  }
  return wrong;
}

}  // namespace rigcal::graph
