#include "server/graph/merge_edges.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "server/graph/graph_jackknife.h"
#include "server/math/covariance.h"
#include "server/math/jackknife.h"
#include "server/math/statistics.h"

namespace rigcal::graph {
namespace {

constexpr double kContradicts = 1e-6;  // odds by chance

using PairKey = std::tuple<SensorId, SensorId, std::string>;

PairKey KeyOf(const Edge& edge) { return {edge.frame_a, edge.frame_b, edge.method}; }

// Omega^+ S Omega^+: what a scatter of scores is as one of poses.
Matrix6d AsPose(const Matrix6d& Omega, const Matrix6d& S) {
  const Matrix6d C = Observable(Omega).covariance;
  return Symmetrized(C * S * C);
}

bool Contradicts(const MergedEdge& merged, const Edge& edge) {
  if (merged.count == 0) return false;
  const Matrix6d C = AsPose(merged.Omega, merged.scatter) + Observable(edge.uncertainty.Omega).covariance;
  const ObservableSubspace both = Observable(C);
  const Vector6d e = (merged.T_a_b.Inverse() * edge.T_a_b).Log();
  return ChiSquareTail(e.dot(both.covariance * e), std::max(1, both.rank)) < kContradicts;
}

Matrix6d ScatterOf(const EdgeBlocks& known) {
  std::vector<Vector6d> d;
  for (const BlockVector& block : known.blocks) d.push_back(block.d);
  return JackknifeCovariance(d);
}

void AddError(const Edge& edge, MergedEdge& merged) {
  const Matrix6d& Omega = edge.uncertainty.Omega;
  const BlocksByEdge blocks = BlocksOf({edge});
  if (blocks.empty()) {
    merged.scatter += Omega;
    return;
  }
  const EdgeBlocks& known = blocks.begin()->second;
  merged.by_blocks = true;
  merged.scatter += Omega * ScatterOf(known) * Omega;
  merged.given += Omega * known.C_given * Omega;
  for (const auto& [name, shifts] : known.shifts) {
    std::vector<Vector6d>& scores = merged.constants[name];
    scores.resize(std::max(scores.size(), shifts.size()), Vector6d::Zero());
    for (std::size_t i = 0; i < shifts.size(); ++i) scores[i] += Omega * shifts[i];
  }
}

void Add(const Edge& edge, Stamp measured_at, MergedEdge& merged) {
  const Matrix6d& Omega = edge.uncertainty.Omega;
  if (merged.count == 0) {
    merged.frame_a = edge.frame_a, merged.frame_b = edge.frame_b, merged.method = edge.method;
    merged.T_a_b = edge.T_a_b;
    merged.newest = measured_at;
  }
  const Vector6d e = (merged.T_a_b.Inverse() * edge.T_a_b).Log();
  merged.Omega += Omega;
  merged.T_a_b = (merged.T_a_b * Se3::Exp(Observable(merged.Omega).covariance * (Omega * e))).Normalized();
  merged.newest = std::max(merged.newest, measured_at);
  merged.source = edge.uncertainty.source;
  merged.dof = std::min(merged.dof, std::numeric_limits<int>::max() - edge.uncertainty.dof) + edge.uncertainty.dof;
  ++merged.count;
  AddError(edge, merged);
}

// Twelve block vectors, two of each direction, whose jackknife is C.
std::vector<BlockVector> BlocksThatScatter(const Matrix6d& C) {
  const Matrix6d root = std::sqrt(12.0 / 22.0) * SquareRoot(C);
  std::vector<BlockVector> blocks;
  for (int k = 0; k < 6; ++k) {
    const std::string axis = std::to_string(k);
    blocks.push_back({axis + "+", root.col(k)});
    blocks.push_back({axis + "-", -root.col(k)});
  }
  return blocks;
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

}  // namespace

Merge MergeOlderEdges(const std::vector<MergedEdge>& before, const std::vector<Edge>& edges,
                      const std::map<EdgeId, Stamp>& measured_at, std::size_t kept) {
  std::map<PairKey, MergedEdge> merged;
  for (const MergedEdge& one : before) merged.emplace(PairKey{one.frame_a, one.frame_b, one.method}, one);
  std::map<PairKey, std::vector<std::pair<Stamp, const Edge*>>> of_pair;
  for (const Edge& edge : edges)
    if (const auto at = measured_at.find(edge.id); edge.state == EdgeState::kGood && edge.session.empty() &&
                                                   !IsMerged(edge) && at != measured_at.end())
      of_pair[KeyOf(edge)].emplace_back(at->second, &edge);
  Merge result;
  for (auto& [key, all] : of_pair) {
    std::sort(all.begin(), all.end(), [](const auto& x, const auto& y) {
      return std::tie(x.first, x.second->id) < std::tie(y.first, y.second->id);
    });
    for (std::size_t i = 0; i + kept < all.size(); ++i) {
      MergedEdge& one = merged[key];
      if (Contradicts(one, *all[i].second)) continue;
      Add(*all[i].second, all[i].first, one);
      result.taken.push_back(all[i].second->id);
    }
  }
  for (auto& [key, one] : merged) result.merged.push_back(std::move(one));
  return result;
}

Edge EdgeOf(const MergedEdge& merged, const RobotId& robot) {
  Edge edge;
  edge.robot = robot;
  edge.frame_a = merged.frame_a, edge.frame_b = merged.frame_b;
  edge.method = merged.method;
  edge.state = EdgeState::kGood;
  edge.T_a_b = merged.T_a_b;
  edge.uncertainty = FromInformation(merged.Omega, merged.source, merged.dof);
  if (merged.by_blocks) {
    edge.uncertainty.blocks = BlocksThatScatter(AsPose(merged.Omega, merged.scatter));
    edge.uncertainty.contributions = ContributionsOf(merged);
  }
  edge.figures.emplace(kMergedEdges, merged.count);
  edge.id = PushedEdgeId(robot, ContentDigest(edge), static_cast<std::uint64_t>(merged.count));
  return edge;
}

}  // namespace rigcal::graph
