#include "server/graph/supernodes.h"

#include <cholmod.h>

namespace rigcal::graph {
namespace {

// The matrix comes in elimination order: CHOLMOD only finds the supernodes.
void Configure(cholmod_common* common) {
  common->print = 0;
  common->supernodal = CHOLMOD_SUPERNODAL;
  common->nmethods = 1;
  common->method[0].ordering = CHOLMOD_NATURAL;
  common->postorder = 1;
  common->nrelax[0] = 1;  // in blocks: merging pays sooner for scalars, which the defaults are meant for
  common->nrelax[1] = 4;
  common->nrelax[2] = 12;
}

cholmod_sparse* LowerPattern(const BlockPattern& pattern, cholmod_common* common) {
  const auto n = static_cast<std::size_t>(pattern.block_count);
  cholmod_sparse* matrix =
      cholmod_allocate_sparse(n, n, n + pattern.off_diagonal.size(), 1, 1, -1, CHOLMOD_PATTERN, common);
  if (matrix == nullptr) return nullptr;
  auto* starts = static_cast<int*>(matrix->p);
  auto* rows = static_cast<int*>(matrix->i);
  std::size_t slot = 0;
  int entry = 0;
  for (int v = 0; v < pattern.block_count; ++v) {
    rows[entry++] = v;
    for (; slot < pattern.off_diagonal.size() && pattern.off_diagonal[slot].col == v; ++slot)
      rows[entry++] = pattern.off_diagonal[slot].row;
    starts[v + 1] = entry;
  }
  return matrix;
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

}  // namespace

Supernode SliceOf(const Supernodes& supernodes, int s) {
  const auto k = static_cast<std::size_t>(s);
  return {supernodes.first_col[k], supernodes.first_col[k + 1] - supernodes.first_col[k],
          supernodes.row_start[k + 1] - supernodes.row_start[k], supernodes.rows.data() + supernodes.row_start[k],
          supernodes.value_start[k]};
}

Supernodes AnalyzeSupernodes(const BlockPattern& pattern, int block_size) {
  Supernodes supernodes;
  cholmod_common common;
  cholmod_start(&common);
  Configure(&common);
  if (cholmod_sparse* matrix = LowerPattern(pattern, &common); matrix != nullptr) {
    if (cholmod_factor* factor = cholmod_analyze(matrix, &common); factor != nullptr) {
      const std::size_t bytes =
          factor->xsize * static_cast<std::size_t>(block_size) * static_cast<std::size_t>(block_size) * sizeof(double);
      if (common.status == CHOLMOD_OK && factor->is_super != 0 && bytes <= kFactorBytesMax)
        supernodes = Spread(*factor, block_size);
      cholmod_free_factor(&factor, &common);
    }
    cholmod_free_sparse(&matrix, &common);
  }
  cholmod_finish(&common);
  return supernodes;
}

}  // namespace rigcal::graph
