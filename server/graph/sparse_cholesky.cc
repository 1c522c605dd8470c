#include "server/graph/sparse_cholesky.h"

#include "server/graph/cholesky_kinds.h"

namespace rigcal::graph {

template <int B>
std::unique_ptr<BlockCholesky<B>> MakeSparseCholesky(const BlockPattern& pattern) {
  Supernodes shape = AnalyzeSupernodes(pattern, B);
  if (shape.size == 0) return nullptr;
  return std::make_unique<SparseCholesky<B>>(pattern, std::move(shape));
}

template std::unique_ptr<BlockCholesky<1>> MakeSparseCholesky<1>(const BlockPattern&);
template std::unique_ptr<BlockCholesky<3>> MakeSparseCholesky<3>(const BlockPattern&);
template std::unique_ptr<BlockCholesky<6>> MakeSparseCholesky<6>(const BlockPattern&);

}  // namespace rigcal::graph
