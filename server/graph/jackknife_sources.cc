#include "server/graph/jackknife_sources.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "server/math/covariance.h"
#include "server/math/jackknife.h"

namespace rigcal::graph {
namespace {

using Eigen::MatrixXd;

constexpr double kShareRounding = 1e-6, kShareMax = 0.999;

// The session's key; an edge that belongs to none stands for itself. '/' is in no id.
std::string SessionKey(const GraphEdge& edge) {
  return edge.session.empty() ? "/" + edge.id.str() : edge.session.str();
}

const EdgeBlocks* FindBlocks(const BlocksByEdge& blocks, const EdgeId& edge) {
  const auto found = blocks.find(edge);
  return found == blocks.end() || found->second.blocks.size() < kJackknifeBlocksMin ? nullptr : &found->second;
}

Eigen::Index PlaceOf(const std::string& id, const std::vector<std::string>& ids) {
  return std::lower_bound(ids.begin(), ids.end(), id) - ids.begin();
}

// d of every block of the session, centred and scaled so that columns * columns^T is the jackknife's sum. A block that
// an edge does not have changes nothing in it.
MatrixXd CentredBlocks(const std::vector<BlockVector>& own, const std::vector<std::string>& ids) {
  const auto count = static_cast<Eigen::Index>(ids.size());
  MatrixXd d = MatrixXd::Zero(6, count);
  for (const BlockVector& block : own) d.col(PlaceOf(block.block_id, ids)) = block.d;
  const Vector6d mean = d.rowwise().mean();
  return BlockScale(count) * (d.colwise() - mean);
}

// What an Omega that the blocks made lacks without each of them; nothing where Omega is known apart from them.
// Captures that the edge does not have made nothing of it, whatever other edges of the session made of them.
std::optional<WeightBlocks> WeightOf(const EdgeBlocks& own, const std::vector<std::string>& ids) {
  if (!(own.weight_share > 0.0)) return std::nullopt;
  WeightBlocks weight{MatrixXd::Zero(6, static_cast<Eigen::Index>(ids.size())), std::vector<char>(ids.size(), 0),
                      own.weight_share};
  Vector6d mean = Vector6d::Zero();
  for (const BlockVector& block : own.blocks) mean += block.d / static_cast<double>(own.blocks.size());
  const double scale = BlockScale(static_cast<Eigen::Index>(own.blocks.size()));
  for (const BlockVector& block : own.blocks) {
    const Eigen::Index place = PlaceOf(block.block_id, ids);
    weight.d.col(place) = scale * (block.d - mean);
    weight.own[static_cast<std::size_t>(place)] = 1;
  }
  return weight;
}

ErrorSource SessionSource(const JackknifeWork& work, const std::vector<std::size_t>& members) {
  std::set<std::string> unique;
  int dof = 0;
  for (const std::size_t k : members) {
    const EdgeBlocks& own = *FindBlocks(work.blocks, work.EdgeOf(k).id);
    for (const BlockVector& block : own.blocks) unique.insert(block.block_id);
    if (own.dof > 0) dof = dof == 0 ? own.dof : std::min(dof, own.dof);
  }
  const std::vector<std::string> ids(unique.begin(), unique.end());
  ErrorSource source;
  source.dof = dof > 0 ? dof : static_cast<int>(ids.size()) - 1;
  source.of_blocks = true;
  source.column_count = static_cast<Eigen::Index>(ids.size());
  for (const std::size_t k : members) {
    const EdgeBlocks& own = *FindBlocks(work.blocks, work.EdgeOf(k).id);
    const MatrixXd d = CentredBlocks(own.blocks, ids);
    source.parts.push_back({k, work.jacobians[k].D * d, WeightOf(own, ids)});
  }
  return source;
}

// The given constants of one name, which every edge that knows them errs by at once: it is the same board, lens or
// lidar in every session, and more of them do not average its error away.
using GivenSources = std::map<std::string, ErrorSource>;

void AddGiven(const JackknifeWork& work, std::size_t constraint, const EdgeBlocks& own, GivenSources& given) {
  for (const auto& [name, shifts] : own.shifts) {
    ErrorSource& source = given[name];
    MatrixXd columns(6, static_cast<Eigen::Index>(shifts.size()));
    for (std::size_t i = 0; i < shifts.size(); ++i) columns.col(static_cast<Eigen::Index>(i)) = shifts[i];
    source.column_count = std::max(source.column_count, columns.cols());
    source.parts.push_back({constraint, work.jacobians[constraint].D * columns, {}});
  }
}

// An edge that knows fewer of the constants does not err by the rest.
void Widen(Eigen::Index column_count, ErrorPart& part) {
  const Eigen::Index known = part.de.cols();
  part.de.conservativeResize(Eigen::NoChange, column_count);
  part.de.rightCols(column_count - known).setZero();
}

ErrorSource OwnError(std::size_t constraint, const MatrixXd& de, int dof) {
  ErrorSource source;
  source.dof = dof;
  source.column_count = de.cols();
  source.parts.push_back({constraint, de, {}});
  return source;
}

// Of what the blocks show in the covariance that Omega stands for; 0 where it is less than they alone would make it.
// Never all of it along any direction: one that a single block shows would have no weight without that block.
double ShareInOmega(const Uncertainty& uncertainty) {
  if (uncertainty.source != UncertaintySource::kJackknife || uncertainty.dof < 1) return 0.0;
  std::vector<Vector6d> d;
  for (const BlockVector& block : uncertainty.blocks) d.push_back(block.d);
  const double most = JackknifeRatioMax(std::min(uncertainty.dof, std::numeric_limits<int>::max() - 1) + 1);
  const double share = uncertainty.jackknife_ratio > 0.0 ? std::min(uncertainty.jackknife_ratio, most) : most;
  const Matrix6d F = SquareRoot(uncertainty.Omega);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(Symmetrized(F.transpose() * JackknifeCovariance(d) * F));
  const double largest = share * eigen.eigenvalues()(5);
  return largest <= 1.0 + kShareRounding ? share * std::min(1.0, kShareMax / largest) : 0.0;
}

// Block vectors that say something in every direction that the edge sees, each for a block of its own.
bool SpeakForTheirEdge(const Uncertainty& uncertainty) {
  if (uncertainty.blocks.size() < kJackknifeBlocksMin) return false;
  std::set<std::string> ids;
  std::vector<Vector6d> d;
  for (const BlockVector& block : uncertainty.blocks) {
    if (!block.d.allFinite() || !ids.insert(block.block_id).second) return false;
    d.push_back(block.d);
  }
  return Observable(JackknifeCovariance(d)).rank >= uncertainty.rank;
}

}  // namespace

double BlockScale(Eigen::Index m) { return std::sqrt(1.0 - 1.0 / static_cast<double>(m)); }

// The covariance that the blocks show is C = sum d_i d_i^T. Without block i it is expected to be the same: what is left
// counts for (m - 1) / (m - 2) of itself, so that C changes by (C - m d_i d_i^T) / (m - 2).
MatrixXd PullByWeight(const WeightBlocks& weight, const Matrix6d& Omega, const MatrixXd& residuals) {
  const auto m = static_cast<double>(std::count(weight.own.begin(), weight.own.end(), 1));
  const Matrix6d C = weight.d * weight.d.transpose();
  MatrixXd pull = MatrixXd::Zero(6, residuals.cols());
  for (Eigen::Index i = 0; i < residuals.cols(); ++i) {
    if (weight.own[static_cast<std::size_t>(i)] == 0) continue;
    const Vector6d d = weight.d.col(i);
    const Matrix6d change = weight.share / (m - 2.0) * (C - m * d * d.transpose()) * Omega;
    pull.col(i) = -Matrix6d(Matrix6d::Identity() + change).partialPivLu().solve(change * residuals.col(i));
  }
  return pull;
}

BlocksByEdge BlocksOf(const std::vector<Edge>& edges) {
  BlocksByEdge blocks;
  for (const Edge& edge : edges) {
    if (edge.state != EdgeState::kGood || !SpeakForTheirEdge(edge.uncertainty)) continue;
    EdgeBlocks& own = blocks[edge.id];
    own.blocks = edge.uncertainty.blocks;
    own.dof = edge.uncertainty.dof;
    own.weight_share = ShareInOmega(edge.uncertainty);
    for (const Contribution& part : edge.uncertainty.contributions)
      if (part.shifts.empty() || !own.shifts.emplace(part.name, part.shifts).second) own.C_given += part.covariance;
  }
  return blocks;
}

std::vector<ErrorSource> SharedSourcesOf(const JackknifeWork& work) {
  std::map<std::string, std::vector<std::size_t>> sessions;
  GivenSources given;
  for (std::size_t k = 0; k < work.problem.constraints.size(); ++k) {
    const GraphEdge& edge = work.EdgeOf(k);
    const EdgeBlocks* blocks = FindBlocks(work.blocks, edge.id);
    if (blocks == nullptr) continue;
    sessions[SessionKey(edge)].push_back(k);
    AddGiven(work, k, *blocks, given);
  }
  std::vector<ErrorSource> sources;
  for (const auto& [key, members] : sessions) sources.push_back(SessionSource(work, members));
  for (auto& [key, source] : given) {
    for (ErrorPart& part : source.parts) Widen(source.column_count, part);
    sources.push_back(std::move(source));
  }
  return sources;
}

ErrorSource OwnSourceOf(const JackknifeWork& work, std::size_t constraint) {
  const GraphEdge& edge = work.EdgeOf(constraint);
  const Matrix6d& D = work.jacobians[constraint].D;
  const EdgeBlocks* blocks = FindBlocks(work.blocks, edge.id);
  if (blocks == nullptr)
    return OwnError(constraint, D * SquareRoot(Observable(work.problem.constraints[constraint].Omega).covariance),
                    edge.dof);
  if (blocks->C_given.isZero(0.0)) return {};
  return OwnError(constraint, D * SquareRoot(blocks->C_given), 0);
}

std::vector<ErrorSource> SourcesOf(const JackknifeWork& work) {
  std::vector<ErrorSource> sources = SharedSourcesOf(work);
  for (std::size_t k = 0; k < work.problem.constraints.size(); ++k)
    if (ErrorSource own = OwnSourceOf(work, k); own.column_count > 0) sources.push_back(std::move(own));
  return sources;
}

bool AnySession(const JackknifeWork& work) {
  const auto& constraints = work.problem.constraints;
  for (std::size_t k = 0; k < constraints.size(); ++k)
    if (FindBlocks(work.blocks, work.EdgeOf(k).id) != nullptr) return true;
  return false;
}

}  // namespace rigcal::graph
