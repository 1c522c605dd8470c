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

// Two poses of one pair with their information, along the directions that both see: (A^-1 + B^-1)^-1 = A (A + B)^+ B.
bool Agree(const Se3& T_x, const Matrix6d& A, const Se3& T_y, const Matrix6d& B) {
  const Matrix6d W = Symmetrized(A * Observable(A + B).covariance * B);
  const int rank = Observable(W).rank;
  const Vector6d e = (T_x.Inverse() * T_y).Log();
  return rank == 0 || ChiSquareTail(e.dot(W * e), rank) >= kContradicts;
}

bool Agree(const Edge& x, const Edge& y) { return Agree(x.T_a_b, x.uncertainty.Omega, y.T_a_b, y.uncertainty.Omega); }

bool Agree(const MergedEdge& merged, const Edge& edge) {
  const Matrix6d by_blocks = Observable(AsPose(merged.Omega, merged.scatter)).covariance;
  return Agree(merged.T_a_b, by_blocks, edge.T_a_b, edge.uncertainty.Omega);
}

// In time, by id where that is the same.
using Timed = std::pair<Stamp, const Edge*>;

// Where merging begins: the first of `older` that at least half of the others agree with, so that it is no wrong one.
std::size_t FirstOf(const std::vector<Timed>& all, std::size_t older) {
  for (std::size_t i = 0; i < older; ++i) {
    std::size_t agreeing = 0;
    for (const Timed& other : all) agreeing += Agree(*all[i].second, *other.second) ? 1 : 0;
    if (2 * agreeing >= all.size() + 1) return i;
  }
  return older;
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

void MergeOldest(const std::vector<Timed>& all, std::size_t older, MergedEdge& merged, std::vector<EdgeId>& taken) {
  const auto take = [&](const Timed& one) {
    Add(*one.second, one.first, merged);
    taken.push_back(one.second->id);
  };
  std::size_t first = all.size();
  if (merged.count == 0) {
    first = FirstOf(all, older);
    if (first == older) return;
    take(all[first]);
  }
  for (std::size_t i = 0; i < older; ++i)
    if (i != first && Agree(merged, *all[i].second)) take(all[i]);
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
  std::map<PairKey, std::vector<Timed>> of_pair;
  for (const Edge& edge : edges)
    if (const auto at = measured_at.find(edge.id); edge.state == EdgeState::kGood && edge.session.empty() &&
                                                   !IsMerged(edge) && at != measured_at.end())
      of_pair[KeyOf(edge)].emplace_back(at->second, &edge);
  Merge result;
  for (auto& [key, all] : of_pair) {
    std::sort(all.begin(), all.end(), [](const auto& x, const auto& y) {
      return std::tie(x.first, x.second->id) < std::tie(y.first, y.second->id);
    });
    if (all.size() > kept) MergeOldest(all, all.size() - kept, merged[key], result.taken);
  }
  for (auto& [key, one] : merged)
    if (one.count > 0) result.merged.push_back(std::move(one));
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
