#include <cholmod.h>

#include <algorithm>
#include <numeric>

#include "server/graph/large/block_matrix.h"

namespace rigcal::graph {
namespace {

class Workspace {
 public:
  Workspace() {
    cholmod_start(&common_);
    common_.print = 0;
  }
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;
  ~Workspace() { cholmod_finish(&common_); }

  [[nodiscard]] cholmod_common* get() { return &common_; }

 private:
  cholmod_common common_;
};

// The lower triangle, diagonal included.
cholmod_sparse* LinkMatrix(const BlockPattern& links, cholmod_common* common) {
  const auto n = static_cast<std::size_t>(links.block_count);
  cholmod_triplet* triplets =
      cholmod_allocate_triplet(n, n, links.off_diagonal.size() + n, -1, CHOLMOD_PATTERN, common);
  if (triplets == nullptr) return nullptr;
  auto* rows = static_cast<int*>(triplets->i);
  auto* cols = static_cast<int*>(triplets->j);
  for (const BlockPosition& at : links.off_diagonal) {
    rows[triplets->nnz] = at.row;
    cols[triplets->nnz++] = at.col;
  }
  for (int v = 0; v < links.block_count; ++v) rows[triplets->nnz] = cols[triplets->nnz] = v, ++triplets->nnz;
  cholmod_sparse* matrix = cholmod_triplet_to_sparse(triplets, 0, common);
  cholmod_free_triplet(&triplets, common);
  return matrix;
}

// The matrix comes in elimination order: CHOLMOD only finds the supernodes.
void Configure(cholmod_common* common) {
  common->supernodal = CHOLMOD_SUPERNODAL;
  common->nmethods = 1;
  common->method[0].ordering = CHOLMOD_NATURAL;
  common->postorder = 1;
  common->nrelax[0] = 1;  // in blocks: merging pays sooner for scalars, which the defaults are meant for
  common->nrelax[1] = 4;
  common->nrelax[2] = 12;
}

// From blocks to scalars.
Supernodes Spread(const cholmod_factor& factor, int block_size) {
  const auto* super = static_cast<const int*>(factor.super);
  const auto* row_start = static_cast<const int*>(factor.pi);
  const auto* rows = static_cast<const int*>(factor.s);
  const auto* order = static_cast<const int*>(factor.Perm);
  Supernodes result;
  result.size = block_size * static_cast<int>(factor.n);
  result.position.resize(static_cast<std::size_t>(result.size));
  for (int p = 0; p < result.size; ++p)
    result.position[static_cast<std::size_t>(block_size * order[p / block_size] + p % block_size)] = p;
  result.supernode_of_col.resize(static_cast<std::size_t>(result.size));
  std::size_t values = 0;
  for (int s = 0; s < static_cast<int>(factor.nsuper); ++s) {
    result.first_col.push_back(block_size * super[s]);
    result.row_start.push_back(static_cast<int>(result.rows.size()));
    result.value_start.push_back(values);
    for (int k = row_start[s]; k < row_start[s + 1]; ++k)
      for (int b = 0; b < block_size; ++b) result.rows.push_back(block_size * rows[k] + b);
    for (int c = block_size * super[s]; c < block_size * super[s + 1]; ++c)
      result.supernode_of_col[static_cast<std::size_t>(c)] = s;
    values += static_cast<std::size_t>(row_start[s + 1] - row_start[s]) * static_cast<std::size_t>(block_size) *
              static_cast<std::size_t>(super[s + 1] - super[s]) * static_cast<std::size_t>(block_size);
  }
  result.first_col.push_back(result.size);
  result.row_start.push_back(static_cast<int>(result.rows.size()));
  result.value_start.push_back(values);
  return result;
}

std::vector<int> NaturalOrder(std::size_t count) {
  std::vector<int> order(count);
  std::iota(order.begin(), order.end(), 0);
  return order;
}

}  // namespace

Elimination EliminationOrder(const BlockPattern& links) {
  Elimination elimination{NaturalOrder(static_cast<std::size_t>(std::max(links.block_count, 0))), {}};
  if (links.block_count <= kBlocksDenseMax) return elimination;
  Workspace workspace;
  if (cholmod_sparse* matrix = LinkMatrix(links, workspace.get()); matrix != nullptr) {
    std::vector<int> found(elimination.order.size());
    if (cholmod_amd(matrix, nullptr, 0, found.data(), workspace.get()) != 0)
      elimination = {std::move(found), {workspace.get()->lnz, workspace.get()->fl}};
    cholmod_free_sparse(&matrix, workspace.get());
  }
  return elimination;
}

std::vector<int> ConstrainedOrder(const BlockPattern& links, const std::vector<bool>& is_last) {
  std::vector<int> order = NaturalOrder(is_last.size()), group(is_last.begin(), is_last.end());
  if (std::count(group.begin(), group.end(), 0) == 0) group.assign(group.size(), 0);  // CAMD takes no empty group
  Workspace workspace;
  if (cholmod_sparse* matrix = LinkMatrix(links, workspace.get()); matrix != nullptr) {
    std::vector<int> found(order.size());
    if (cholmod_camd(matrix, nullptr, 0, group.data(), found.data(), workspace.get()) != 0) order = std::move(found);
    cholmod_free_sparse(&matrix, workspace.get());
  }
  return order;
}

Supernode SliceOf(const Supernodes& supernodes, int s) {
  const auto k = static_cast<std::size_t>(s);
  return {supernodes.first_col[k], supernodes.first_col[k + 1] - supernodes.first_col[k],
          supernodes.row_start[k + 1] - supernodes.row_start[k], supernodes.rows.data() + supernodes.row_start[k],
          supernodes.value_start[k]};
}

Supernodes AnalyzeSupernodes(const BlockPattern& pattern, int block_size) {
  Supernodes supernodes;
  Workspace workspace;
  cholmod_common* common = workspace.get();
  Configure(common);
  if (cholmod_sparse* matrix = LinkMatrix(pattern, common); matrix != nullptr) {
    if (cholmod_factor* factor = cholmod_analyze(matrix, common); factor != nullptr) {
      const std::size_t bytes =
          factor->xsize * static_cast<std::size_t>(block_size) * static_cast<std::size_t>(block_size) * sizeof(double);
      if (common->status == CHOLMOD_OK && factor->is_super != 0 && bytes <= kFactorBytesMax)
        supernodes = Spread(*factor, block_size);
      cholmod_free_factor(&factor, common);
    }
    cholmod_free_sparse(&matrix, common);
  }
  return supernodes;
}

}  // namespace rigcal::graph
