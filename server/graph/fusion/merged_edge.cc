#include "server/graph/fusion/merged_edge.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/graph/fusion/joined_information.h"
#include "server/graph/fusion/session_fusion.h"
#include "server/graph/uncertainty/graph_jackknife.h"
#include "server/math/covariance.h"
#include "server/math/jackknife.h"
#include "server/math/statistics.h"
#include "server/model/edges/weak_edge.h"

namespace rigcal::graph {
namespace {

constexpr double kContradicts = 1e-6;  // odds by chance

// Omega^+ S Omega^+: what a scatter of scores is as one of poses.
Matrix6d AsPose(const Matrix6d& Omega, const Matrix6d& S) {
  const Matrix6d C = Observable(Omega).covariance;
  return Symmetrized(C * S * C);
}

// Two poses of one pair with their information, along the directions that both see: (A^-1 + B^-1)^-1 = A (A + B)^+ B.
bool Agree(const Se3& T_x, const Matrix6d& A, const Se3& T_y, const Matrix6d& B) {
  const Matrix6d W = Symmetrized(A * Observable(A + B).covariance * B);
  const int rank = Observable(W).rank;
  const Vector6d e = (T_x.Inverse() * T_y).Log();
  return rank == 0 || ChiSquareTail(e.dot(W * e), rank) >= kContradicts;
}

// Of rotation, of what is known by Omega.
double RotationVariance_rad2(const Matrix6d& Omega) {
  return Observable(Omega).covariance.bottomRightCorner<3, 3>().trace();
}

// What noise turns directions by that two measurements leave open, e apart.
double TurnedBy_rad(const Matrix6d& A, const Matrix6d& B, const Vector6d& e) {
  return std::sqrt(std::max(e.tail<3>().squaredNorm(), RotationVariance_rad2(A) + RotationVariance_rad2(B)));
}

void AddError(const Edge& edge, const Matrix6d& Omega, MergedEdge& merged) {
  const BlocksByEdge blocks = BlocksOf({edge});
  if (blocks.empty()) {
    merged.scatter += Omega;
    return;
  }
  const EdgeBlocks& known = blocks.begin()->second;
  merged.by_blocks = true;
  merged.scatter += Omega * JackknifeCovariance(VectorsOf(known.blocks)) * Omega;
  merged.given += Omega * known.C_given * Omega;
  for (const auto& [name, shifts] : known.shifts) {
    std::vector<Vector6d>& scores = merged.constants[name];
    scores.resize(std::max(scores.size(), shifts.size()), Vector6d::Zero());
    for (std::size_t i = 0; i < shifts.size(); ++i) scores[i] += Omega * shifts[i];
  }
}

// Twelve block vectors, two of each direction, whose jackknife is C; no other edge has them.
std::vector<BlockVector> BlocksThatScatter(const Matrix6d& C, const std::string& pair) {
  const Matrix6d root = std::sqrt(12.0 / 22.0) * SquareRoot(C);
  std::vector<BlockVector> blocks;
  for (int k = 0; k < 6; ++k) {
    const std::string axis = pair + "/" + std::to_string(k);
    blocks.push_back({axis + "+", root.col(k)});
    blocks.push_back({axis + "-", -root.col(k)});
  }
  return blocks;
}

// One block vector more than there are columns, and as many as count at least, whose jackknife is columns columns^T;
// the same blocks for all edges with as many columns. By Helmert's rows, which are orthonormal and add up to zero.
std::vector<BlockVector> BlocksOfColumns(Eigen::MatrixXd columns) {
  const Eigen::Index given = columns.cols(), least = static_cast<Eigen::Index>(kJackknifeBlocksMin) - 1;
  if (given < least) {
    columns.conservativeResize(Eigen::NoChange, least);
    columns.rightCols(least - given).setZero();
  }
  const Eigen::Index m = columns.cols() + 1;
  Eigen::MatrixXd d = Eigen::MatrixXd::Zero(6, m);
  Vector6d later = Vector6d::Zero();  // sum over k > j of column k over sqrt(k (k + 1)): what block j has of them
  for (Eigen::Index j = m - 1; j >= 0; --j) {
    const auto k = static_cast<double>(j);
    d.col(j) = later;
    if (j == 0) break;
    d.col(j) -= k / std::sqrt(k * (k + 1.0)) * columns.col(j - 1);
    later += columns.col(j - 1) / std::sqrt(k * (k + 1.0));
  }
  d *= std::sqrt(static_cast<double>(m) / static_cast<double>(m - 1));
  std::vector<BlockVector> blocks;
  for (Eigen::Index j = 0; j < m; ++j) blocks.push_back({"merged/" + std::to_string(j), d.col(j)});
  return blocks;
}

std::vector<BlockVector> MergedBlocksOf(const MergedEdge& merged) {
  if (merged.scores.cols() == 0)
    return BlocksThatScatter(AsPose(merged.Omega, merged.scatter + merged.visits),
                             merged.frame_a.str() + "/" + merged.frame_b.str() + "/" + merged.method);
  return BlocksOfColumns(Observable(merged.Omega).covariance * merged.scores);
}

std::vector<Contribution> ContributionsOf(const MergedEdge& merged) {
  std::vector<Contribution> contributions;
  if (!merged.given.isZero(0.0)) contributions.push_back({"given", AsPose(merged.Omega, merged.given)});
  const Matrix6d C = Observable(merged.Omega).covariance;
  for (const auto& [name, scores] : merged.constants) {
    Contribution part{name};
    for (const Vector6d& score : scores) {
      part.shifts.emplace_back(C * score);
      part.covariance += part.shifts.back() * part.shifts.back().transpose();
    }
    contributions.push_back(std::move(part));
  }
  return contributions;
}

// Information of what is known by Omega, of which the place scatters besides; none along what it does not see.
Matrix6d Widened(const Matrix6d& Omega, const Matrix6d& between) {
  if (between.isZero(0.0)) return Omega;
  const Matrix6d C = Observable(Omega).covariance;
  const Matrix6d seen = C * Omega;  // a projector
  return Observable(C + seen * between * seen.transpose()).covariance;
}

}  // namespace

bool Agree(const Edge& x, const Edge& y, const Matrix6d& between) {
  return Agree(x.T_a_b, Widened(x.uncertainty.Omega, between), y.T_a_b, Widened(y.uncertainty.Omega, between));
}

bool Agree(const MergedEdge& merged, const Edge& edge, const Matrix6d& between) {
  Matrix6d scatter = merged.scatter + merged.visits + merged.given;
  for (const auto& [name, scores] : merged.constants)
    for (const Vector6d& score : scores) scatter += score * score.transpose();
  const Matrix6d told = Observable(AsPose(merged.Omega, scatter)).covariance;
  return Agree(merged.T_a_b, told, edge.T_a_b, Widened(edge.uncertainty.Omega, between));
}

void Add(const Edge& edge, Stamp measured_at, MergedEdge& merged, const Matrix6d& between) {
  if (merged.count == 0) {
    merged.frame_a = edge.frame_a, merged.frame_b = edge.frame_b, merged.method = edge.method;
    merged.T_a_b = edge.T_a_b;
    merged.newest = measured_at;
  }
  const Vector6d e = (merged.T_a_b.Inverse() * edge.T_a_b).Log();
  Matrix6d Omega = edge.uncertainty.Omega;
  if (edge.uncertainty.rank < 6) {  // what it leaves open, as the merged pose has it
    const Matrix6d J = RightJacobian(e);
    Omega = Symmetrized(J.transpose() * Omega * J);
  }
  merged.Omega = JoinedInformation(merged.Omega, Omega, TurnedBy_rad(merged.Omega, Omega, e), merged.T_a_b.p_m.norm());
  merged.T_a_b = (merged.T_a_b * Se3::Exp(Observable(merged.Omega).covariance * (Omega * e))).Normalized();
  merged.newest = std::max(merged.newest, measured_at);
  merged.source = edge.uncertainty.source;
  merged.dof = std::min(merged.dof, std::numeric_limits<int>::max() - edge.uncertainty.dof) + edge.uncertainty.dof;
  ++merged.count;
  if (!between.isZero(0.0)) merged.visits += Omega * between * Omega;
  AddError(edge, Omega, merged);
}

Edge AsUnsureAsOff(const Edge& edge, const MergedEdge& merged, const Matrix6d& between) {
  const Vector6d e = (merged.T_a_b.Inverse() * edge.T_a_b).Log();
  const VisitVariance off{e.segment<3>(tangent::kTranslation).squaredNorm(),
                          e.segment<3>(tangent::kRotation).squaredNorm()};
  Edge less = edge;
  const Uncertainty& known = edge.uncertainty;
  less.uncertainty = FromInformation(Widened(known.Omega, between + off.Matrix()), known.source, known.dof);
  return less;
}

Edge EdgeOf(const MergedEdge& merged, const RobotId& robot, bool blocks) {
  Edge edge;
  edge.robot = robot;
  edge.frame_a = merged.frame_a, edge.frame_b = merged.frame_b;
  edge.method = merged.method;
  edge.state = EdgeState::kGood;
  edge.T_a_b = merged.T_a_b;
  edge.uncertainty =
      FromInformation(Widened(merged.Omega, AsPose(merged.Omega, merged.visits)), merged.source, merged.dof);
  edge.figures.emplace(merged.of_sessions ? kMergedSessions : kMergedEdges, merged.count);
  if (merged.weak) edge.figures.emplace(kMergedWeak, 1.0);
  if (merged.part > 0) edge.figures.emplace(kMergedPart, merged.part);
  edge.id = PushedEdgeId(robot, ContentDigest(edge), static_cast<std::uint64_t>(merged.count));
  if (merged.by_blocks) edge.uncertainty.contributions = ContributionsOf(merged);
  if (merged.by_blocks && blocks) edge.uncertainty.blocks = MergedBlocksOf(merged);
  return edge;
}

}  // namespace rigcal::graph
