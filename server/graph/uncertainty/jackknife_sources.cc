#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <set>

#include "server/graph/uncertainty/graph_jackknife.h"
#include "server/math/covariance.h"
#include "server/math/jackknife.h"
#include "server/model/edges/merged_edge.h"

namespace rigcal::graph {
namespace {

using Eigen::MatrixXd;

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

// By which d_i is multiplied so that the jackknife's sum over m blocks is the sum of squares.
double BlockScale(Eigen::Index m) { return std::sqrt(1.0 - 1.0 / static_cast<double>(m)); }

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
    source.parts.push_back({k, work.jacobians[k].D * d});
  }
  return source;
}

// Its columns are sums over many sessions, not blocks: as sure as the pair that most sessions saw.
void TakeAsHistory(const JackknifeWork& work, const std::vector<std::size_t>& members, ErrorSource& source) {
  source.of_blocks = false;
  source.dof = 0;
  for (const std::size_t k : members)
    source.dof = std::max(source.dof, FindBlocks(work.blocks, work.EdgeOf(k).id)->dof);
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
    source.parts.push_back({constraint, work.jacobians[constraint].D * columns});
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
  source.parts.push_back({constraint, de});
  return source;
}

// Block vectors that say something in every direction that the edge sees, each for a block of its own.
bool SpeakForTheirEdge(const Uncertainty& uncertainty) {
  if (uncertainty.blocks.size() < kJackknifeBlocksMin) return false;
  std::set<std::string> ids;
  for (const BlockVector& block : uncertainty.blocks)
    if (!block.d.allFinite() || !ids.insert(block.block_id).second) return false;
  return Observable(JackknifeCovariance(VectorsOf(uncertainty.blocks))).rank >= uncertainty.rank;
}

}  // namespace

MatrixXd CentredBlocks(const std::vector<BlockVector>& own, const std::vector<std::string>& ids) {
  const auto count = static_cast<Eigen::Index>(ids.size());
  MatrixXd d = MatrixXd::Zero(6, count);
  for (const BlockVector& block : own) d.col(PlaceOf(block.block_id, ids)) = block.d;
  const Vector6d mean = d.rowwise().mean();
  return BlockScale(count) * (d.colwise() - mean);
}

BlocksByEdge BlocksOf(const std::vector<Edge>& edges) {
  BlocksByEdge blocks;
  for (const Edge& edge : edges) {
    if (edge.state != EdgeState::kGood || !SpeakForTheirEdge(edge.uncertainty)) continue;
    EdgeBlocks& own = blocks[edge.id];
    own.blocks = edge.uncertainty.blocks;
    own.dof = edge.uncertainty.dof;
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
  for (const auto& [key, members] : sessions) {
    sources.push_back(SessionSource(work, members));
    if (key == kMergedHistory.str()) TakeAsHistory(work, members, sources.back());
  }
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

CheckedDirections CheckWhitened(const Matrix6d& C, const Vector6d& e) {
  constexpr double kCheckedRatio = 1e-6;
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(Symmetrized(C));
  const Vector6d parts = eigen.eigenvectors().transpose() * e;
  CheckedDirections checked;
  for (int k = 0; k < 6; ++k) {
    if (!(eigen.eigenvalues()(k) > kCheckedRatio)) continue;
    ++checked.rank;
    checked.t_squared += parts(k) * parts(k) / eigen.eigenvalues()(k);
  }
  return checked;
}

}  // namespace rigcal::graph
