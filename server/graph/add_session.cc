#include <Eigen/QR>
#include <algorithm>
#include <set>

#include "server/graph/graph_jackknife.h"
#include "server/graph/merged_edge.h"
#include "server/math/covariance.h"

namespace rigcal::graph {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

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

// Beyond so many pairs what they have in common is let go: it would be a matrix of as many rows and columns, times six.
constexpr std::size_t kPairsTogetherMax = 200;

void AddApart(const std::vector<const Edge*>& good, Stamp captured_at, MergedPairs& merged) {
  for (auto& [pair, one] : merged) one.scores.resize(Eigen::NoChange, 0);  // `scatter` has each pair's own
  for (const Edge* edge : good) {
    MergedEdge& one = merged[PairOf(*edge)];
    one.of_sessions = true;
    Add(*edge, captured_at, one);
  }
}

void AddTogether(const std::vector<const Edge*>& edges, Stamp captured_at, MergedPairs& merged) {
  std::vector<Edge> good;
  for (const Edge* edge : edges) good.push_back(*edge);
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
    Add(edge, captured_at, one);
  }
  for (auto& [pair, one] : merged) Widen(own, one);
}

// As few columns as pairs have directions, with the same products among all pairs: R of S^T = Q R, as S S^T = R^T R.
void Compress(MergedPairs& merged) {
  const Index rows = 6 * static_cast<Index>(merged.size()), columns = ColumnsOf(merged);
  if (columns == 0) return;
  for (auto& [pair, one] : merged) one.scatter = one.scores * one.scores.transpose();
  if (columns > rows) {
    MatrixXd transposed(columns, rows);
    Index at = 0;
    for (const auto& [pair, one] : merged) transposed.middleCols<6>(at) = one.scores.transpose(), at += 6;
    const Eigen::HouseholderQR<Eigen::Ref<MatrixXd>> qr(transposed);
    const MatrixXd R = qr.matrixQR().topRows(rows).triangularView<Eigen::Upper>();
    at = 0;
    for (auto& [pair, one] : merged) one.scores = R.middleCols<6>(at).transpose(), at += 6;
  }
}

}  // namespace

void AddSession(const std::vector<const Edge*>& good, Stamp captured_at, MergedPairs& merged) {
  if (merged.size() > kPairsTogetherMax) return AddApart(good, captured_at, merged);
  AddTogether(good, captured_at, merged);
  Compress(merged);
}

}  // namespace rigcal::graph
