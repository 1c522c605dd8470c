#include <Eigen/QR>
#include <algorithm>
#include <set>
#include <tuple>

#include "server/graph/graph_jackknife.h"
#include "server/graph/merge_edges.h"
#include "server/graph/merged_edge.h"
#include "server/math/covariance.h"

namespace rigcal::graph {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

using PairKey = std::tuple<SensorId, SensorId, std::string>;
using MergedPairs = std::map<PairKey, MergedEdge>;

PairKey PairOf(const Edge& edge) { return {edge.frame_a, edge.frame_b, edge.method}; }

struct SessionEdges {
  Stamp captured_at;
  SessionId id;
  std::vector<const Edge*> good, rest;  // by id
};

std::vector<SessionEdges> OldestFirst(const std::vector<Edge>& edges, const std::map<EdgeId, Stamp>& measured_at) {
  std::map<SessionId, SessionEdges> by_id;
  for (const Edge& edge : edges) {
    const auto at = measured_at.find(edge.id);
    if (edge.session.empty() || IsMerged(edge) || at == measured_at.end()) continue;
    SessionEdges& session = by_id[edge.session];
    session.id = edge.session, session.captured_at = at->second;
    (edge.state == EdgeState::kGood ? session.good : session.rest).push_back(&edge);
  }
  std::vector<SessionEdges> sessions;
  for (auto& [id, session] : by_id) sessions.push_back(std::move(session));
  for (SessionEdges& session : sessions)
    for (auto* list : {&session.good, &session.rest})
      std::sort(list->begin(), list->end(), [](const Edge* x, const Edge* y) { return x->id < y->id; });
  std::sort(sessions.begin(), sessions.end(), [](const SessionEdges& x, const SessionEdges& y) {
    return std::tie(x.captured_at, x.id) < std::tie(y.captured_at, y.id);
  });
  return sessions;
}

// How many of `sessions` come before the newest `kept` that have a good edge.
std::size_t CountOlder(const std::vector<SessionEdges>& sessions, std::size_t kept) {
  std::size_t older = sessions.size();
  for (std::size_t counting = 0; older > 0 && counting < kept;)
    if (!sessions[--older].good.empty()) ++counting;
  return older;
}

// Where nothing was merged yet of the pair, half of its edges must agree with the one that merging begins with.
bool Fits(const Edge& edge, const MergedPairs& merged, const std::vector<SessionEdges>& window) {
  if (const auto found = merged.find(PairOf(edge)); found != merged.end()) return Agree(found->second, edge);
  std::size_t all = 0, agreeing = 0;
  for (const SessionEdges& session : window)
    for (const Edge* other : session.good)
      if (PairOf(*other) == PairOf(edge)) ++all, agreeing += Agree(edge, *other) ? 1 : 0;
  return 2 * agreeing >= all + 1;
}

Index ColumnsOf(const MergedPairs& merged) {
  Index columns = 0;
  for (const auto& [pair, one] : merged) columns = std::max(columns, one.scores.cols());
  return columns;
}

void Widen(Index columns, MergedEdge& merged) {
  const Index before = merged.scores.cols();
  merged.scores.conservativeResize(Eigen::NoChange, columns);
  merged.scores.rightCols(columns - before).setZero();
}

// Block ids of a session, of all its edges that have blocks.
std::vector<std::string> BlockIdsOf(const BlocksByEdge& blocks) {
  std::set<std::string> ids;
  for (const auto& [edge, own] : blocks)
    for (const BlockVector& block : own.blocks) ids.insert(block.block_id);
  return {ids.begin(), ids.end()};
}

// What the edge's score errs by: by the session's blocks, a column each, or by itself.
MatrixXd ScoresOf(const Edge& edge, const BlocksByEdge& blocks, const std::vector<std::string>& ids) {
  const auto own = blocks.find(edge.id);
  if (own == blocks.end()) return SquareRoot(edge.uncertainty.Omega);
  return edge.uncertainty.Omega * CentredBlocks(own->second.blocks, ids);
}

void AddSession(const SessionEdges& session, MergedPairs& merged) {
  std::vector<Edge> good;
  for (const Edge* edge : session.good) good.push_back(*edge);
  const BlocksByEdge blocks = BlocksOf(good);
  const std::vector<std::string> ids = BlockIdsOf(blocks);
  const Index shared = ColumnsOf(merged);
  Index own = shared + static_cast<Index>(ids.size());
  for (const Edge& edge : good) {
    MergedEdge& one = merged[PairOf(edge)];
    one.of_sessions = true;
    const bool by_blocks = blocks.contains(edge.id);
    const MatrixXd scores = ScoresOf(edge, blocks, ids);
    const Index at = by_blocks ? shared : own;
    own += by_blocks ? 0 : scores.cols();
    Widen(std::max(one.scores.cols(), at + scores.cols()), one);
    one.scores.middleCols(at, scores.cols()) += scores;
    Add(edge, session.captured_at, one);
  }
  for (auto& [pair, one] : merged) Widen(own, one);
}

// As few columns as pairs have directions, with the same products among all pairs: R of S^T = Q R, as S S^T = R^T R.
void Compress(MergedPairs& merged) {
  const Index rows = 6 * static_cast<Index>(merged.size()), columns = ColumnsOf(merged);
  if (columns > rows) {
    MatrixXd transposed(columns, rows);
    Index at = 0;
    for (const auto& [pair, one] : merged) transposed.middleCols<6>(at) = one.scores.transpose(), at += 6;
    const Eigen::HouseholderQR<Eigen::Ref<MatrixXd>> qr(transposed);
    const MatrixXd R = qr.matrixQR().topRows(rows).triangularView<Eigen::Upper>();
    at = 0;
    for (auto& [pair, one] : merged) one.scores = R.middleCols<6>(at).transpose(), at += 6;
  }
  for (auto& [pair, one] : merged) one.scatter = one.scores * one.scores.transpose();
}

void Take(const std::vector<const Edge*>& edges, std::vector<EdgeId>& taken) {
  for (const Edge* edge : edges) taken.push_back(edge->id);
}

}  // namespace

Merge MergeOlderSessions(const std::vector<MergedEdge>& before, const std::vector<Edge>& edges,
                         const std::map<EdgeId, Stamp>& measured_at, std::size_t kept) {
  MergedPairs merged;
  for (const MergedEdge& one : before)
    if (one.of_sessions) merged.emplace(PairKey{one.frame_a, one.frame_b, one.method}, one);
  const std::vector<SessionEdges> sessions = OldestFirst(edges, measured_at);
  const std::size_t older = CountOlder(sessions, kept);
  Merge result;
  for (std::size_t i = 0; i < older; ++i) {
    const SessionEdges& session = sessions[i];
    if (!std::all_of(session.good.begin(), session.good.end(), [&](const Edge* edge) { return Fits(*edge, merged, sessions); }))
      continue;
    if (!session.good.empty()) AddSession(session, merged), Compress(merged);
    Take(session.good, result.taken);
    Take(session.rest, result.taken);
  }
  for (auto& [pair, one] : merged) result.merged.push_back(std::move(one));
  return result;
}

}  // namespace rigcal::graph
