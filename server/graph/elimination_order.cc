#include <cholmod.h>

#include <algorithm>
#include <numeric>

#include "server/graph/block_matrix.h"

namespace rigcal::graph {
namespace {

cholmod_sparse* LinkMatrix(int vertex_count, const std::vector<std::pair<int, int>>& links, cholmod_common* common) {
  const auto n = static_cast<std::size_t>(vertex_count);
  cholmod_triplet* triplets = cholmod_allocate_triplet(n, n, links.size() + n, -1, CHOLMOD_PATTERN, common);
  if (triplets == nullptr) return nullptr;
  auto* rows = static_cast<int*>(triplets->i);
  auto* cols = static_cast<int*>(triplets->j);
  for (const auto& [a, b] : links) {
    rows[triplets->nnz] = std::max(a, b);
    cols[triplets->nnz++] = std::min(a, b);
  }
  for (int v = 0; v < vertex_count; ++v) rows[triplets->nnz] = cols[triplets->nnz] = v, ++triplets->nnz;
  cholmod_sparse* matrix = cholmod_triplet_to_sparse(triplets, 0, common);
  cholmod_free_triplet(&triplets, common);
  return matrix;
}

}  // namespace

Elimination EliminationOrder(int vertex_count, const std::vector<std::pair<int, int>>& links) {
  Elimination elimination;
  std::vector<int>& order = elimination.order;
  order.resize(static_cast<std::size_t>(std::max(vertex_count, 0)));
  std::iota(order.begin(), order.end(), 0);
  if (vertex_count <= kBlocksDenseMax) return elimination;
  cholmod_common common;
  cholmod_start(&common);
  common.print = 0;
  if (cholmod_sparse* matrix = LinkMatrix(vertex_count, links, &common); matrix != nullptr) {
    std::vector<int> found(order.size());
    if (cholmod_amd(matrix, nullptr, 0, found.data(), &common) != 0) {
      order = std::move(found);
      elimination.cost = {common.lnz, common.fl};
    }
    cholmod_free_sparse(&matrix, &common);
  }
  cholmod_finish(&common);
  return elimination;
}

std::vector<int> ConstrainedOrder(const BlockPattern& links, const std::vector<bool>& is_last) {
  std::vector<int> order(is_last.size()), group(is_last.begin(), is_last.end());
  std::iota(order.begin(), order.end(), 0);
  if (std::count(group.begin(), group.end(), 0) == 0) group.assign(group.size(), 0);  // CAMD takes no empty group
  std::vector<std::pair<int, int>> pairs;
  for (const BlockPosition& at : links.off_diagonal) pairs.emplace_back(at.row, at.col);
  cholmod_common common;
  cholmod_start(&common);
  common.print = 0;
  if (cholmod_sparse* matrix = LinkMatrix(links.block_count, pairs, &common); matrix != nullptr) {
    std::vector<int> found(order.size());
    if (cholmod_camd(matrix, nullptr, 0, group.data(), found.data(), &common) != 0) order = std::move(found);
    cholmod_free_sparse(&matrix, &common);
  }
  cholmod_finish(&common);
  return order;
}

}  // namespace rigcal::graph
